//! The worked values of the glossary are those that the program computes.

use taxel_core::description::{DESCRIPTORS, Description, Descriptor, regions};
use taxel_core::imprint::Imprint;
use taxel_core::sensor::Sensor;
use taxel_core::touch::Plane;
use taxel_files::formats::value;

use crate::common;
use crate::docs::document;

/// Returns the section that the screen shows for a descriptor, too.
fn section<'a>(glossary: &'a str, key: &str) -> &'a str {
    let anchor = format!("id=\"{key}\"></a>");
    let mut sections = glossary.split("\n<a ");
    let section = sections.find(|section| section.contains(&anchor));
    section.unwrap_or_else(|| panic!("no section for {key}"))
}

/// Returns the value of a descriptor as people read it.
fn read(row: &Descriptor, imprint: &Imprint) -> Option<String> {
    let described = Description::of(&regions(imprint)[0]);
    value::text((row.measure)(&described), row.dimension)
}

#[test]
fn every_descriptor_has_a_section_with_its_value_for_the_ring_of_fig_1() {
    let glossary = document("docs/glossary.md");
    let ring = "ellipse radius_x=4 radius_y=4 x0=1.99 y0=1.47 thickness=2";
    let ring = Plane::new(Sensor::default()).touch(&common::figure(ring, 16));
    for row in DESCRIPTORS {
        let (_, worked) = section(&glossary, row.key)
            .rsplit_once("Fig. 1: ")
            .unwrap_or_else(|| panic!("no worked value of {}", row.key));
        let start = format!("{} = ", row.symbol);
        let line = worked.lines().find_map(|line| line.split_once(&start));
        let shown = line.unwrap_or_else(|| panic!("{start}: {worked}")).1;
        let values = read(row, &ring).unwrap_or_else(|| "none".to_owned());
        for value in values.split(", ") {
            assert!(shown.contains(value), "{start}{value}: {shown}");
        }
    }
}

#[test]
fn the_other_drawings_have_the_values_below_them() {
    let glossary = document("docs/glossary.md");
    let drawn: [(&str, &[&str]); 3] = [
        (
            "..##../.####./######/######/.####./..##..",
            &["f", "roundness"],
        ),
        ("############/############", &["f", "roundness"]),
        ("##..../##..../##..../######", &["cg_cd", "cg_cd_direction"]),
    ];
    for (rows, keys) in drawn {
        for row in DESCRIPTORS.iter().filter(|row| keys.contains(&row.key)) {
            let value = read(row, &common::grid(rows)).expect("it has a value");
            let text = section(&glossary, row.key);
            assert!(text.contains(&value), "{} {value} of {rows}", row.key);
        }
    }
}
