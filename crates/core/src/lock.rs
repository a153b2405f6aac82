//! Mutexes that can be locked even after a panic of another thread.

use std::sync::TryLockError;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Locks a mutex. A panic while it was locked does not matter: whoever locks one here leaves its value whole at every
/// step, or reports the panic elsewhere.
pub fn locked<T: ?Sized>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Locks a mutex as [`locked`] does, but does not wait: returns None if it is locked already.
pub fn try_locked<T: ?Sized>(mutex: &Mutex<T>) -> Option<MutexGuard<'_, T>> {
    match mutex.try_lock() {
        Ok(guard) => Some(guard),
        Err(TryLockError::Poisoned(panicked)) => Some(panicked.into_inner()),
        Err(TryLockError::WouldBlock) => None,
    }
}
