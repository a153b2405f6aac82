//! Texts and arrays: shapes, jobs, imprints in every format, ranges, numpy headers, settings.

use taxel::cli::settings::Settings;
use taxel_core::imprint::Imprint;
use taxel_core::outline::{Outline, Ring};
use taxel_core::picture::Picture;
use taxel_core::pose::{DecimalRange, MAX_VALUES};
use taxel_core::sensor::Sensor;
use taxel_core::sweep::Shard;
use taxel_core::touch::Plane;
use taxel_files::formats::numpy::{Elements, Header, Number, header};
use taxel_files::formats::{
    DescribedImprint, Drawing, ExportFormat, Job, OutlineOptions, StoredShape, imprint_file,
    is_svg, read_outline,
};

use super::{is_short, refused};

/// Reads a file of the library.
pub(crate) fn shape(bytes: &[u8]) -> bool {
    match StoredShape::read(bytes) {
        Ok(shape) => {
            let again = StoredShape::read(shape.write().as_bytes());
            assert_eq!(again.as_ref(), Ok(&shape));
            true
        }
        Err(error) => refused(&error.to_string()),
    }
}

/// Reads a line of `taxel batch`.
pub(crate) fn job(bytes: &[u8]) -> bool {
    let lookup = |name: &str| match name {
        "washer" => Ok(Picture::at_home(Imprint::empty(Sensor::default().size())).into()),
        _ => Err("no shape named so".to_owned()),
    };
    match Job::read(bytes, Sensor::default(), Some(2.5), &lookup) {
        Ok(job) => {
            let mut plane = Plane::new(Sensor::default());
            let imprint = job.imprint(&mut plane);
            let answer =
                serde_json::to_string(&DescribedImprint(&imprint)).expect("every number is finite");
            assert!(!answer.contains('\n'));
            true
        }
        Err(error) => refused(&error.to_string()),
    }
}

/// Reads an imprint as text.
pub(crate) fn imprint(bytes: &[u8]) -> bool {
    let Ok(text) = str::from_utf8(bytes) else {
        return false;
    };
    match text.parse::<Imprint>() {
        Ok(imprint) => {
            assert_eq!(imprint.to_string().parse(), Ok(imprint));
            true
        }
        Err(error) => refused(&error.to_string()),
    }
}

/// Reads an imprint in other programs' formats: text, CSV, NPY.
pub(crate) fn exchange(bytes: &[u8]) -> bool {
    match imprint_file::read(bytes) {
        Ok(imprint) => {
            let forms = ExportFormat::ALL.iter();
            for form in forms.filter(|form| form.name != ExportFormat::SVG) {
                assert_eq!(
                    imprint_file::read(&(form.write)(&Drawing::new(&imprint))),
                    Ok(imprint)
                );
            }
            true
        }
        Err(error) => refused(&error.to_string()),
    }
}

/// Reads an SVG, or the data of a path in each line. Its rings are always an outline.
pub(crate) fn svg(bytes: &[u8]) -> bool {
    let mut document = String::from_utf8_lossy(bytes).into_owned();
    if !is_svg(bytes) {
        let data = document.replace(['<', '&', '"'], " ");
        let path = |data: &str| format!("<path fill-rule=\"evenodd\" d=\"{data}\"/>");
        document = format!("<svg>{}</svg>", data.lines().map(path).collect::<String>());
    }
    match read_outline(document.as_bytes(), &OutlineOptions::default()) {
        Ok(read) => {
            Outline::new(read.rings, None).expect("rings that do not cross");
            true
        }
        Err(error) => refused(&error.to_string()),
    }
}

/// Reads points.
pub(crate) fn points(bytes: &[u8]) -> bool {
    let options = OutlineOptions::default();
    match read_outline(bytes, &options) {
        Ok(read) if !is_svg(bytes) => {
            let mut text = String::new();
            for ring in &read.rings {
                let Ring::Polygon(points) = ring else {
                    panic!("points are polygons");
                };
                // Closed, so that a ring that ends as it begins is the same again.
                for [x, y] in points.iter().chain(&points[..1]) {
                    text += &format!("{x:?},{y:?}\n");
                }
                text.push('\n');
            }
            let again = read_outline(text.as_bytes(), &options);
            if read
                .rings
                .iter()
                .all(|ring| matches!(ring, Ring::Polygon(points) if points.len() > 2))
            {
                assert_eq!(again.as_ref(), Ok(&read));
            }
            true
        }
        Ok(_) => true,
        Err(error) => refused(&error.to_string()),
    }
}

/// Reads a settings file.
pub(crate) fn config(bytes: &[u8]) -> bool {
    let Ok(text) = str::from_utf8(bytes) else {
        return false;
    };
    match Settings::read(text) {
        Ok(_) => true,
        Err(error) => {
            let line = error
                .strip_prefix("line ")
                .and_then(|error| error.split(',').next());
            let line = line.and_then(|line| line.parse::<usize>().ok());
            let lines = text.split('\n').count();
            assert!(
                line.is_some_and(|line| (1..=lines).contains(&line)),
                "{error}"
            );
            refused(&error)
        }
    }
}

/// Reads a range `start:end:step`, and a shard `K/N`.
pub(crate) fn range(bytes: &[u8]) -> bool {
    let Ok(text) = str::from_utf8(bytes) else {
        return false;
    };
    let range = text.parse::<DecimalRange>();
    match &range {
        Ok(range) => {
            assert_eq!(range.to_string().parse().as_ref(), Ok(range), "{text:?}");
            assert!((1..=MAX_VALUES).contains(&range.count()));
            assert!(range.step() > 0.0 && range.last().is_finite());
            // All values differ, and none is beyond the last.
            let middle = range.count() / 2;
            let some = [0, 1, middle, middle + 1, range.count() - 1];
            for index in some {
                assert_eq!(index == 0, range.value(index) == range.value(0));
                assert!(index >= range.count() || range.value(index) <= range.last());
            }
        }
        Err(error) => is_short(&error.to_string()),
    }
    let shard = text.parse::<Shard>();
    match &shard {
        Ok(shard) => {
            assert_eq!(shard.to_string().parse().as_ref(), Ok(shard));
            let rows = shard.rows(u64::MAX);
            assert!(rows.start < rows.end, "some of so many are in each shard");
        }
        Err(error) => is_short(&error.to_string()),
    }
    range.is_ok() || shard.is_ok()
}

/// Reads the header of a numpy file; one of a plain array of bytes can be written and read again.
pub(crate) fn npy(bytes: &[u8]) -> bool {
    let mut rest = bytes;
    match Header::read(&mut rest) {
        Ok(own) => {
            assert!(rest.len() + 10 <= bytes.len());
            let again = header(Number::U8, &own.shape);
            let again = Header::read(&mut &again[..]).expect("just written");
            assert_eq!(
                (again.descr, again.shape),
                (Elements::Code("|u1".to_owned()), own.shape)
            );
            true
        }
        Err(error) => refused(&error.to_string()),
    }
}
