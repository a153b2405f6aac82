//! Names the imprints of frames, on a thread of its own: it reads or trains the model, then answers one imprint after the
//! other.
//!
//! ```text
//! begin(set, noise)  -> the thread prepares the model
//! name(imprint)      -> Named, or NotNamed: why there is no model
//! ```
//! Without a receiver of events, as in a script, an imprint is answered at once.

use std::cell::OnceCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;

use crate::imprint::Imprint;
use crate::recognition::{Evidence, Model, Noise};
use crate::tui::explore::message::WorkerEvent;
use crate::tui::live::message::LiveEvent;
use crate::tui::live::naming::NamedImprint;
use crate::tui::recognise::sets::ModelChoice;
use crate::tui::runtime::models::ModelStore;
use crate::tui::runtime::progress::{WorkerEventSink, guarded};
use crate::tui::runtime::threads;

/// A model that is asked on the thread that waits for its answer.
#[derive(Debug)]
struct OwnModel {
    /// Where the model is read from.
    store: ModelStore,
    /// Which set it is of.
    choice: ModelChoice,
    /// The noise of the sensor; None to take each taxel as it is read.
    noise: Option<Noise>,
    /// The model, or why there is none.
    model: OnceCell<Result<Model, String>>,
}

/// Names imprints by the model that was chosen last.
#[derive(Debug, Default)]
pub(super) struct ShapeNamer {
    /// The number of the source whose frames are named.
    number: u64,
    /// What is named by, where there is no thread; the model is prepared when the first imprint comes.
    here: Option<OwnModel>,
    /// The way to the thread; dropped to end it. None without a thread.
    imprints: Option<Sender<Imprint>>,
    /// Set to break off a training.
    stop: Arc<AtomicBool>,
    /// Waited for at the end of the program, so that a model is written as a whole.
    thread: Option<JoinHandle<()>>,
}

impl ShapeNamer {
    /// Prepares a model in place of the one before. Events carry the number of the source whose frames are named.
    pub(super) fn begin(
        &mut self,
        number: u64,
        store: ModelStore,
        (choice, noise): (ModelChoice, Option<Noise>),
        post: Option<WorkerEventSink>,
    ) {
        self.end();
        self.number = number;
        self.stop = Arc::default();
        let stop = Arc::clone(&self.stop);
        let Some(post) = post else {
            self.here = Some(OwnModel {
                store,
                choice,
                noise,
                model: OnceCell::new(),
            });
            return;
        };
        let (imprints, waiting) = channel::<Imprint>();
        self.imprints = Some(imprints);
        let refused = Arc::clone(&post);
        let work = move || {
            let ended = guarded(number, || {
                let progress = |_: u64| !stop.load(Ordering::Relaxed);
                let model = match store.model(&choice, &|_| (), &progress) {
                    Ok(model) => model,
                    Err(reason) => return WorkerEvent::Live(number, LiveEvent::NotNamed(reason)),
                };
                while let Ok(imprint) = waiting.recv() {
                    let named = named(&model, noise.as_ref(), &imprint);
                    post(WorkerEvent::Live(number, LiveEvent::Named(Box::new(named))));
                }
                WorkerEvent::Live(number, LiveEvent::Waiting)
            });
            post(ended);
        };
        let thread = std::thread::Builder::new().spawn(move || threads::run(work));
        match thread {
            Ok(thread) => self.thread = Some(thread),
            Err(error) => {
                let reason = format!("the system gives no thread for it: {error}");
                refused(WorkerEvent::Live(number, LiveEvent::NotNamed(reason)));
            }
        }
    }

    /// Answers an imprint: at once, or later by an event.
    pub(super) fn name(&self, imprint: &Imprint) -> Option<WorkerEvent> {
        if let Some(imprints) = &self.imprints {
            // A thread that has ended has said why.
            let _ = imprints.send(*imprint);
            return None;
        }
        let own = self.here.as_ref()?;
        let train = || own.store.model(&own.choice, &|_| (), &|_| true);
        let event = match own.model.get_or_init(train) {
            Ok(model) => LiveEvent::Named(Box::new(named(model, own.noise.as_ref(), imprint))),
            Err(reason) => LiveEvent::NotNamed(reason.clone()),
        };
        Some(WorkerEvent::Live(self.number, event))
    }

    /// Names nothing any more. Returns the thread, which ends by itself.
    pub(super) fn leave(&mut self) -> Option<JoinHandle<()>> {
        let thread = self.thread.take();
        self.end();
        thread
    }

    /// Names nothing any more. The thread ends by itself: an answer under way is not waited for.
    pub(super) fn end(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.imprints = None;
        self.here = None;
        self.thread = None;
    }
}

/// Names an imprint, with the noise of the sensor where that is known. One touch is all the evidence: frames of a
/// source may be of different shapes.
fn named(model: &Model, noise: Option<&Noise>, imprint: &Imprint) -> NamedImprint {
    let touches = [*imprint];
    let evidence = Evidence::of(&touches).under(noise);
    NamedImprint::new(model, imprint, &model.recognise(evidence))
}
