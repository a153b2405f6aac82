//! Reuses memory. Otherwise each block's answers would get fresh memory from the system, which clears it page by
//! page: with two threads, this takes a sixth of the time.

use std::sync::{Mutex, MutexGuard};

use crate::lock::locked;

/// The largest buffer that is kept, in bytes, so that a single long answer does not keep its memory to the end.
const LARGEST: usize = 1 << 20;

/// The unused buffers. There are never more than were in use at one time.
#[derive(Debug, Default)]
pub(crate) struct Buffers(Mutex<Vec<Vec<u8>>>);

impl Buffers {
    pub(crate) fn take(&self) -> Vec<u8> {
        let Some(buffer) = self.unused().pop() else {
            return Vec::new();
        };
        buffer
    }

    /// Keeps a buffer for later, unless it is larger than [`LARGEST`].
    pub(crate) fn give_back(&self, mut buffer: Vec<u8>) {
        if buffer.capacity() > 0 && buffer.capacity() <= LARGEST {
            buffer.clear();
            self.unused().push(buffer);
        }
    }

    /// Locks the buffers. No panic is possible while they are locked, so they are never damaged.
    fn unused(&self) -> MutexGuard<'_, Vec<Vec<u8>>> {
        locked(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_buffer_is_used_again_and_empty() {
        let buffers = Buffers::default();
        let mut buffer = buffers.take();
        buffer.extend_from_slice(b"an answer");
        let (place, capacity) = (buffer.as_ptr(), buffer.capacity());
        buffers.give_back(buffer);
        let again = buffers.take();
        assert_eq!((again.as_ptr(), again.capacity()), (place, capacity));
        assert!(again.is_empty());
        assert_eq!(buffers.take().capacity(), 0, "nothing else is kept");
    }

    #[test]
    fn a_very_large_buffer_is_not_kept() {
        let buffers = Buffers::default();
        buffers.give_back(Vec::with_capacity(2 * LARGEST));
        assert_eq!(buffers.take().capacity(), 0);
    }
}
