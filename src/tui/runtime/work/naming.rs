//! Names the imprints of frames, on a thread of its own: it reads or trains the model, then names one imprint after
//! the other.
//!
//! ```text
//! begin(set, noise)  -> the thread prepares the model
//! name(imprint)      -> Named, or NotNamed: why there is no model
//! ```
//! Without a receiver of events, as in a script, an imprint is named at once.

use std::cell::OnceCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

use crate::imprint::Imprint;
use crate::recognition::Model;
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::live::message::LiveEvent;
use crate::tui::live::naming::{NamedImprint, NamingRequest};
use crate::tui::runtime::work::execution::{
    Execution, PoseLimit, StopFlag, WorkProgress, caught, start,
};
use crate::tui::runtime::work::models::ModelStore;

#[derive(Debug)]
struct OwnModel {
    store: ModelStore,
    naming: NamingRequest,
    limit: PoseLimit,
    model: OnceCell<Result<Model, String>>,
}

#[derive(Debug, Default)]
pub(in crate::tui::runtime) struct ShapeNamer {
    number: u64,
    /// The model to name by, if there is no thread; it is prepared when the first imprint comes.
    here: Option<OwnModel>,
    /// The channel to the thread, dropped to end it; None without a thread.
    imprints: Option<Sender<Imprint>>,
    /// The flag that stops a training; no events are sent any more then.
    stop: StopFlag,
    /// The thread, which is waited for at the end of the program, so that a model is written as a whole.
    thread: Option<JoinHandle<()>>,
}

impl ShapeNamer {
    /// Prepares a model in place of the one before. Events carry the number of the source whose frames are named, and
    /// the number of the request.
    pub(in crate::tui::runtime) fn begin(
        &mut self,
        number: u64,
        store: ModelStore,
        naming: NamingRequest,
        execution: &Execution,
    ) {
        self.end();
        self.number = number;
        let stop = self.stop.renew();
        let post = match execution {
            Execution::AtOnce(limit) => {
                self.here = Some(OwnModel {
                    store,
                    naming,
                    limit: *limit,
                    model: OnceCell::new(),
                });
                return;
            }
            Execution::OnThreads(post) => Arc::clone(post),
        };
        let (imprints, waiting) = channel::<Imprint>();
        self.imprints = Some(imprints);
        let by = naming.number;
        let refused = Arc::clone(&post);
        let work = move || {
            let say = |event| {
                // Nobody waits for the answers of a model that was given up.
                if !stop.load(Ordering::Relaxed) {
                    post(WorkerEvent::Live(number, event));
                }
            };
            let ended = caught(|| answer(&store, &naming, &waiting, &stop, &say));
            if let Err(reason) = ended.flatten() {
                say(LiveEvent::NotNamed(by, reason));
            }
        };
        let thread = start(work);
        match thread {
            Ok(thread) => self.thread = Some(thread),
            Err(reason) => {
                refused(WorkerEvent::Live(number, LiveEvent::NotNamed(by, reason)));
            }
        }
    }

    /// Names an imprint: at once, or later by an event.
    pub(in crate::tui::runtime) fn name(&self, imprint: &Imprint) -> Option<WorkerEvent> {
        if let Some(imprints) = &self.imprints {
            // A thread that has ended has said why.
            let _ = imprints.send(*imprint);
            return None;
        }
        let own = self.here.as_ref()?;
        let NamingRequest {
            number,
            choice,
            noise,
        } = &own.naming;
        let train = || {
            own.store
                .model(choice, &|_| {}, &WorkProgress::up_to(own.limit))
        };
        let event = match own.model.get_or_init(train) {
            Ok(model) => {
                let named = NamedImprint::new(model, imprint, noise.as_ref());
                LiveEvent::Named(*number, Box::new(named))
            }
            Err(reason) => LiveEvent::NotNamed(*number, reason.clone()),
        };
        Some(WorkerEvent::Live(self.number, event))
    }

    /// Stops naming. The thread ends by itself: an answer under way is not waited for.
    pub(in crate::tui::runtime) fn end(&mut self) {
        self.stop.stop();
        self.imprints = None;
        self.here = None;
    }

    /// Stops for good. Returns the thread that was begun last, also if it was stopped before: it may still write the
    /// model.
    pub(in crate::tui::runtime) fn leave(&mut self) -> Option<JoinHandle<()>> {
        self.end();
        self.thread.take()
    }
}

fn answer(
    store: &ModelStore,
    naming: &NamingRequest,
    imprints: &Receiver<Imprint>,
    stop: &AtomicBool,
    say: &dyn Fn(LiveEvent),
) -> Result<(), String> {
    let progress = WorkProgress::until(stop, None);
    let model = store.model(&naming.choice, &|_| {}, &progress)?;
    while let Ok(imprint) = imprints.recv() {
        let named = NamedImprint::new(&model, &imprint, naming.noise.as_ref());
        say(LiveEvent::Named(naming.number, Box::new(named)));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;
    use crate::lock::locked;
    use crate::storage::ModelChoice;

    #[test]
    fn a_training_that_is_given_up_sends_no_event() {
        let events = Arc::new(Mutex::new(Vec::new()));
        let posted = Arc::clone(&events);
        let threads = Execution::OnThreads(Arc::new(move |event| locked(&posted).push(event)));
        let mut namer = ShapeNamer::default();
        let naming = |number, choice| NamingRequest {
            number,
            choice,
            noise: None,
        };
        let store = ModelStore::default();
        let figures = naming(1, ModelChoice::Figures);
        namer.begin(7, store.clone(), figures, &threads);
        namer.end();
        let given_up = namer.leave().expect("a thread");
        let missing = ModelChoice::File("no/such.taxel".into());
        namer.begin(7, store, naming(2, missing), &threads);
        let next = namer.thread.take().expect("a thread");
        for thread in [given_up, next] {
            thread.join().expect("no panic");
        }
        let events = locked(&events);
        let [WorkerEvent::Live(7, LiveEvent::NotNamed(2, reason))] = &events[..] else {
            panic!("{events:?}");
        };
        assert!(reason.contains("no/such.taxel"), "{reason}");
    }
}
