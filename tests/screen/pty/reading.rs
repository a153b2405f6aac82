//! Reading from a disk that hangs: keys keep working, the status line says what the program waits for, the result goes
//! to the page that asked for it, Esc gives up waiting, and the end does not wait.

use std::fs;
use std::path::Path;

use rustix::process::Signal;
use taxel::formats::{Name, StoredShape};
use taxel::imprint::Imprint;
use taxel::sensor::Sensor;
use taxel::storage::{Expected, Library};

use super::program::{Program, Start};
use super::tracer::Tracer;

/// The call that opens a file or a folder.
const OPENING: &str = "?openat";

/// Makes a library with one shape of seven taxels, `stripe`.
fn library() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let mut imprint = Imprint::empty(Sensor::default().size());
    for column in 0..7 {
        imprint.set(column, 3, true);
    }
    let name = Name::new("stripe").expect("a name");
    let sensor = Sensor::new(16, 16).expect("a sensor");
    let shape = StoredShape::new(name, sensor, imprint, None).expect("of one size");
    let library = Library::open(folder.path().to_owned());
    library.save(&shape, Expected::Nothing).expect("saved");
    folder
}

/// Starts the program with a library.
fn started(library: &Path) -> Program {
    Program::started(&Start {
        library: Some(library),
        ..Start::default()
    })
}

#[test]
fn keys_typed_while_the_list_is_read_are_not_lost() {
    let folder = library();
    let mut program = started(folder.path());
    let Some(hanging) = Tracer::hang(&mut program, OPENING, &[folder.path()]) else {
        return;
    };
    program.types(b"l");
    program.shows("the library is being read");
    program.shows("Listing the shapes: waiting for the disk; Esc gives up");
    program.resize((100, 30));
    program.types(b"strip");
    program.shows("filter: strip");
    program.types(b"\r");
    hanging.end();
    program.shows("stripe loaded");
    program.shows("NA 7 in all");
    program.types(b"q");
    program.ends_well(0);
}

#[test]
fn the_shapes_of_a_list_may_be_read_after_their_names() {
    let folder = library();
    let mut program = started(folder.path());
    let file = folder.path().join("stripe.json");
    let Some(hanging) = Tracer::hang(&mut program, OPENING, &[&file]) else {
        return;
    };
    program.types(b"l");
    program.shows("stripe");
    program.shows("Reading the shapes: waiting for the disk");
    program.types(b"\x1b[B");
    hanging.end();
    // The preview of the shape.
    program.types(b"\x1b[A");
    program.shows("NA 7, pieces 1");
    program.types(b"\x1b");
    program.shows("? Help");
    program.types(b"q");
    program.ends_well(0);
}

#[test]
fn esc_gives_up_waiting() {
    let folder = library();
    let mut program = started(folder.path());
    let Some(hanging) = Tracer::hang(&mut program, OPENING, &[folder.path()]) else {
        return;
    };
    for _ in 0..2 {
        program.types(b"l");
        program.shows("Listing the shapes: waiting for the disk");
        program.types(b"\x1b");
        program.shows("Listing the shapes: stopped waiting");
    }
    program.types(b" ");
    program.shows("NA 1 in all");
    program.types(b"u");
    program.shows("undone");
    hanging.end();
    program.types(b"l");
    program.shows("stripe");
    program.types(b"strip\r");
    program.shows("stripe loaded");
    program.types(b"q");
    program.ends_well(0);
}

#[test]
fn a_later_request_is_not_given_up_with_the_one_that_hangs() {
    let folder = library();
    let mut program = started(folder.path());
    let file = folder.path().join("a.txt");
    fs::write(&file, "#.#\n").expect("written");
    let Some(hanging) = Tracer::hang(&mut program, OPENING, &[&file]) else {
        return;
    };
    program.types(format!(":open {}\r", file.display()).as_bytes());
    program.shows("waiting for the disk; Esc gives up");
    program.types(b":load stripe\r");
    program.types(b"\x1b");
    program.shows("stripe loaded");
    program.shows("NA 7 in all");
    hanging.end();
    program.types(b"q");
    program.ends_well(0);
}

#[test]
fn a_shape_is_loaded_when_the_page_opened_meanwhile_is_closed() {
    let folder = library();
    let mut program = started(folder.path());
    let file = folder.path().join("stripe.json");
    let Some(hanging) = Tracer::hang(&mut program, OPENING, &[&file]) else {
        return;
    };
    program.types(b":load stripe\r");
    program.shows("Loading stripe: waiting for the disk; Esc gives up");
    program.types(b":");
    program.types(b"strange words");
    program.shows("strange words");
    hanging.end();
    program.types(b", typed on");
    program.shows("strange words, typed on");
    // Esc closes the prompt, and does not give up what another page is waiting for.
    program.types(b"\x1b");
    program.shows("stripe loaded");
    program.shows("NA 7 in all");
    program.types(b"q");
    program.ends_well(0);
}

#[test]
fn a_file_that_is_no_longer_waited_for_is_not_opened() {
    let folder = library();
    let mut program = started(folder.path());
    let file = folder.path().join("a.txt");
    fs::write(&file, "#.#\n").expect("written");
    let Some(hanging) = Tracer::hang(&mut program, OPENING, &[&file]) else {
        return;
    };
    let command = format!(":open {}\r", file.display());
    program.types(command.as_bytes());
    program.shows("waiting for the disk; Esc gives up");
    program.types(b"\x1b");
    program.shows("stopped waiting");
    hanging.end();
    program.types(b" ");
    program.shows("NA 1 in all");
    // When it is requested again, it is opened.
    program.types(command.as_bytes());
    program.shows("NA 2 in all");
    program.types(b"qy");
    program.ends_well(0);
}

#[test]
fn names_that_arrive_late_do_not_change_the_line() {
    let folder = library();
    let mut program = started(folder.path());
    let Some(hanging) = Tracer::hang(&mut program, OPENING, &[folder.path()]) else {
        return;
    };
    program.types(b":load stri\t");
    program.shows("Listing the shapes: waiting for the disk");
    program.types(b"x");
    program.shows(":load strix");
    hanging.end();
    program.types(b"\x7f\t");
    program.shows(":load stripe");
    program.types(b"\r");
    program.shows("stripe loaded");
    program.types(b"q");
    program.ends_well(0);
}

#[test]
fn the_end_does_not_wait_for_reading() {
    for (keys, signal, status) in [
        (&b"\x03\x03"[..], None, 0),
        (b"", Some(Signal::TERM), 143),
        (b"", Some(Signal::HUP), 129),
    ] {
        let folder = library();
        let mut program = started(folder.path());
        let Some(hanging) = Tracer::hang(&mut program, OPENING, &[folder.path()]) else {
            return;
        };
        program.types(b"l");
        program.shows("Listing the shapes: waiting for the disk");
        for key in keys {
            program.types(&[*key]);
        }
        if let Some(signal) = signal {
            program.signal(signal);
        }
        ends_before(&mut program, hanging, status);
    }
}

/// Waits for the end while the disk hangs.
fn ends_before(program: &mut Program, hanging: Tracer, status: i32) {
    // The system keeps the rest of the process for the tracer.
    program.until("its end", |program| program.state() == 'Z');
    hanging.end();
    program.ends_well(status);
}

#[test]
fn the_end_does_not_wait_for_a_model() {
    let folder = tempfile::tempdir().expect("a folder");
    let models = folder.path().join("models");
    fs::create_dir(&models).expect("made");
    let model = models.join("own.npz");
    fs::write(&model, "").expect("written");
    let mut program = started(&folder.path().join("library"));
    let Some(hanging) = Tracer::hang(&mut program, OPENING, &[&model]) else {
        return;
    };
    program.types(b":recognise own\r");
    program.shows("being read");
    program.types(b"\x1b");
    program.shows("Reading model own: stopped waiting");
    program.types(b"\x1b");
    program.shows("? Help");
    program.types(b"q");
    ends_before(&mut program, hanging, 0);
}

#[test]
fn waiting_for_a_model_does_not_block_keys() {
    let folder = tempfile::tempdir().expect("a folder");
    let models = folder.path().join("models");
    fs::create_dir(&models).expect("made");
    let model = models.join("own.npz");
    fs::write(&model, "").expect("written");
    let mut program = started(&folder.path().join("library"));
    let Some(hanging) = Tracer::hang(&mut program, OPENING, &[&model]) else {
        return;
    };
    let waiting = "Reading model own; Esc gives up";
    program.types(b":recognise own\r");
    program.shows(waiting);
    // Keys keep working.
    program.types(b" ");
    program.shows("NA 1 in all");
    program.types(b"\x1b");
    program.shows("stopped waiting");
    program.shows("not read; Enter reads it");
    program.types(b"\r");
    program.shows(waiting);
    hanging.end();
    program.shows("own.npz");
    program.shows("not read; Enter reads it");
    program.types(b"\x1b");
    program.shows("? Help");
    program.types(b"qy");
    program.ends_well(0);
}

/// The first thread is one of those that share the work; the second is refused.
#[test]
fn work_runs_on_one_thread_if_too_few_can_be_started() {
    let folder = library();
    let mut program = started(folder.path());
    let Some(_tracer) = Tracer::refuse_threads(&mut program, "2") else {
        return;
    };
    program.types(b":recognise figures\r");
    program.shows("limit: error");
    program.types(b"\x1b");
    program.shows("? Help");
    program.types(b"f\re\r");
    program.shows("imprint 0 at");
    // Sorting and filtering run on the screen's own thread.
    program.types(b"s/na > 1\r");
    program.shows("na > 1");
    program.types(b"\x1b");
    program.shows("? Help");
    program.types(b"qy");
    program.ends_well(0);
}

#[test]
fn shapes_are_read_if_no_threads_can_be_started() {
    let folder = library();
    let mut program = started(folder.path());
    let Some(_tracer) = Tracer::refuse_threads(&mut program, "1+") else {
        return;
    };
    program.types(b"lstripe\r");
    program.shows("stripe loaded");
    program.types(b"s\x15copy\r");
    program.shows("saved as copy");
    program.types(b"q");
    program.ends_well(0);
}
