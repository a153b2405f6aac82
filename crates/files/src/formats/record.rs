//! JSON objects whose keys are parameters, sensors and imprints: the building blocks of jobs and stored shapes.
//!
//! Keys that are parameters are looked up in the table of parameters; duplicate and unexpected keys are refused.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use taxel_core::figure::{Figure, FigureKind};
use taxel_core::imprint::{Imprint, ImprintRows};
use taxel_core::parameter::{PARAMETERS, Parameter, ParameterError};
use taxel_core::picture::{PICTURE_PARAMETERS, Picture};
use taxel_core::quote::{did_you_mean, shortened};
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor};
use taxel_core::source::Source;

/// The error for an object without a meaning, although it is JSON and its keys are known.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecordError {
    /// A value out of range, or missing.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A key that this kind of object does not have.
    #[error("{key}: does not belong to {article} {thing}{expected}", article = article(thing))]
    Foreign {
        /// The key that does not belong here.
        key: &'static str,
        /// The kind of object.
        thing: &'static str,
        /// The keys that do belong here, as a clause of a sentence; empty if there are none.
        expected: String,
    },
    /// A name that is not one of the seven figures.
    #[error(
        "figure: {found:?} is unknown, expected one of {}{}",
        FigureKind::names().join(", "),
        figure_meant(found)
    )]
    FigureKind {
        /// The name that was given.
        found: String,
    },
    /// None, or several, of the keys that say what an object is.
    #[error("expected exactly one of the keys {0}")]
    Which(&'static str),
    /// A picture's name where names cannot be looked up, or one that was not found.
    #[error("picture: {0}")]
    Name(String),
}

/// Returns the end of the message about an unknown figure: which one was probably meant.
fn figure_meant(found: &str) -> String {
    match FigureKind::of_other_name(found) {
        Some(known) => format!("; {known}"),
        None => did_you_mean(found, FigureKind::names()),
    }
}

fn article(noun: &str) -> &'static str {
    if noun.starts_with(['a', 'e', 'i', 'o', 'u']) {
        "an"
    } else {
        "a"
    }
}

/// The values of the parameters that were given, in the order of [`PARAMETERS`], which is that of [`Parameter`].
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Values([Option<f64>; PARAMETERS.len()]);

impl Values {
    pub(crate) fn get(&self, parameter: Parameter) -> Option<f64> {
        self.0[parameter as usize]
    }

    pub(crate) fn set(&mut self, parameter: Parameter, value: f64) {
        self.0[parameter as usize] = Some(value);
    }

    /// Refuses the first value whose parameter is not an expected one.
    pub(crate) fn only(
        &self,
        thing: &'static str,
        expected: &[Parameter],
    ) -> Result<(), RecordError> {
        let foreign = PARAMETERS
            .iter()
            .zip(self.0)
            .find(|(row, value)| value.is_some() && !expected.contains(&row.parameter));
        foreign.map_or(Ok(()), |(row, _)| {
            let expected = expected
                .iter()
                .map(|parameter| parameter.row().key)
                .collect::<Vec<_>>()
                .join(", ");
            let expected = match expected.as_str() {
                "" => String::new(),
                keys => format!(", expected {keys}"),
            };
            Err(RecordError::Foreign {
                key: row.key,
                thing,
                expected,
            })
        })
    }

    pub(crate) fn figure(&self, kind: FigureKind, sensor: &Sensor) -> Result<Figure, RecordError> {
        self.only(kind.name(), kind.parameters())?;
        Ok(Figure::new(kind, sensor, |parameter| self.get(parameter))?)
    }

    fn picture(&self, imprint: &Imprint, sensor: &Sensor) -> Result<Picture, RecordError> {
        self.only("picture", PICTURE_PARAMETERS)?;
        Ok(Picture::new(*imprint, sensor, |parameter| {
            self.get(parameter)
        })?)
    }

    /// Makes a sensor from these values; the missing ones are those of `base`.
    pub(crate) fn sensor(&self, base: Sensor) -> Result<Sensor, RecordError> {
        self.only("sensor", SENSOR_PARAMETERS)?;
        SENSOR_PARAMETERS
            .iter()
            .copied()
            .try_fold(base, |sensor, parameter| match self.get(parameter) {
                Some(value) => Ok(sensor.with(parameter, value)?),
                None => Ok(sensor),
            })
    }
}

#[derive(Clone, Debug)]
pub(crate) enum ImprintOrName<'a> {
    /// An imprint, given as rows of `#` and `.`.
    Imprint(Box<Imprint>),
    /// The name of a shape.
    Name(Cow<'a, str>),
}

impl ImprintOrName<'_> {
    pub(crate) fn imprint(
        &self,
        lookup: &dyn Fn(&str) -> Result<Imprint, String>,
    ) -> Result<Imprint, RecordError> {
        match self {
            Self::Imprint(imprint) => Ok(**imprint),
            Self::Name(name) => lookup(name).map_err(RecordError::Name),
        }
    }
}

/// Looks up no names, for files that are complete in themselves.
pub(crate) fn no_names(_: &str) -> Result<Imprint, String> {
    Err(format!("expected {ROWS}"))
}

/// An object with any of the keys that occur in jobs, sensors and sources.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record<'a> {
    pub(crate) figure: Option<Cow<'a, str>>,
    /// The rows or the name of a picture.
    pub(crate) picture: Option<ImprintOrName<'a>>,
    pub(crate) imprint: Option<Imprint>,
    pub(crate) sensor: Option<Values>,
    /// The values of all keys that are parameters.
    pub(crate) values: Values,
}

impl Record<'_> {
    /// Returns the figure or the picture of the record. Exactly one of the two keys must be there, and not `imprint`.
    pub(crate) fn source(
        &self,
        sensor: &Sensor,
        lookup: &dyn Fn(&str) -> Result<Imprint, String>,
    ) -> Result<Source, RecordError> {
        match (&self.figure, &self.picture, &self.imprint) {
            (Some(name), None, None) => {
                let kind = name.parse().map_err(|_| RecordError::FigureKind {
                    found: shortened(name),
                })?;
                Ok(Source::Figure(self.values.figure(kind, sensor)?))
            }
            (None, Some(content), None) => {
                let imprint = content.imprint(lookup)?;
                Ok(Source::Picture(self.values.picture(&imprint, sensor)?))
            }
            _ => Err(RecordError::Which("figure, picture, imprint")),
        }
    }

    /// Refuses a sensor, for objects in which it would change nothing.
    pub(crate) fn no_sensor(&self, thing: &'static str) -> Result<(), RecordError> {
        if self.sensor.is_none() {
            return Ok(());
        }
        Err(RecordError::Foreign {
            key: "sensor",
            thing,
            expected: String::new(),
        })
    }
}

pub(crate) trait KeyedObject<'de>: Default {
    /// The kind of object, with its article, for the message about anything else.
    const EXPECTED: &'static str;

    fn take_key<A: MapAccess<'de>>(&mut self, key: &str, map: &mut A) -> Result<(), A::Error>;
}

pub(crate) fn keyed_object<'de, T: KeyedObject<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<T, D::Error> {
    struct ObjectVisitor<T>(PhantomData<T>);
    impl<'de, T: KeyedObject<'de>> Visitor<'de> for ObjectVisitor<T> {
        type Value = T;
        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str(T::EXPECTED)
        }
        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<T, A::Error> {
            let mut object = T::default();
            while let Some(Text(key)) = map.next_key()? {
                object.take_key(&key, &mut map)?;
            }
            Ok(object)
        }
    }
    deserializer.deserialize_map(ObjectVisitor(PhantomData))
}

impl<'de: 'a, 'a> Deserialize<'de> for Record<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        keyed_object::<Record<'de>, D>(deserializer)
    }
}

impl<'de> KeyedObject<'de> for Record<'de> {
    const EXPECTED: &'static str = "an object with a figure, a picture or an imprint";

    fn take_key<A: MapAccess<'de>>(&mut self, key: &str, map: &mut A) -> Result<(), A::Error> {
        self.take(key, map, &RECORD_KEYS)
    }
}

impl<'a> Record<'a> {
    pub(crate) fn take<'de: 'a, A: MapAccess<'de>>(
        &mut self,
        key: &str,
        map: &mut A,
        known: &KnownKeys,
    ) -> Result<(), A::Error> {
        match key {
            "figure" => {
                let Text(name) = value_of("figure", map)?;
                once("figure", &mut self.figure, name)
            }
            "picture" => once("picture", &mut self.picture, value_of("picture", map)?),
            "imprint" => {
                let ImprintRecord(imprint) = value_of("imprint", map)?;
                once("imprint", &mut self.imprint, imprint)
            }
            "sensor" => once("sensor", &mut self.sensor, value_of("sensor", map)?),
            other => self.values.take(other, map, known),
        }
    }
}

/// The keys that an object may have.
pub(crate) struct KnownKeys {
    /// The keys that a message about an unknown key lists.
    pub(crate) named: &'static [&'static str],
    /// More keys, listed after those.
    pub(crate) others: &'static [&'static str],
    /// Whether the keys of all parameters are known as well.
    pub(crate) parameters: bool,
}

const RECORD_KEYS: KnownKeys = KnownKeys {
    named: &["figure", "picture", "imprint", "sensor"],
    others: &[],
    parameters: true,
};
const SENSOR_KEYS: KnownKeys = KnownKeys {
    named: &{
        let mut keys = [""; SENSOR_PARAMETERS.len()];
        let mut index = 0;
        while index < keys.len() {
            keys[index] = SENSOR_PARAMETERS[index].row().key;
            index += 1;
        }
        keys
    },
    others: &[],
    parameters: false,
};

impl KnownKeys {
    pub(crate) fn unknown(&self, key: &str) -> String {
        let mut named = [self.named, self.others].concat();
        let parameters = self
            .parameters
            .then(|| PARAMETERS.iter().map(|row| row.key));
        let parameters = parameters.into_iter().flatten();
        let meant = did_you_mean(key, named.iter().copied().chain(parameters));
        if self.parameters {
            named.push("a parameter");
        }
        let mut text = format!("unknown key {:?}, expected ", shortened(key));
        for (index, name) in named.iter().enumerate() {
            text += match index {
                0 => "",
                index if index + 1 == named.len() => " or ",
                _ => ", ",
            };
            text += name;
        }
        text + &meant
    }
}

/// Reads the value of a key; an error names the key and keeps its position.
pub(crate) fn value_of<'de, T: Deserialize<'de>, A: MapAccess<'de>>(
    key: &str,
    map: &mut A,
) -> Result<T, A::Error> {
    map.next_value()
        .map_err(|error: A::Error| A::Error::custom(format_args!("{key}: {error}")))
}

/// Stores the value of a key.
pub(crate) fn once<T, E: Error>(
    key: &'static str,
    slot: &mut Option<T>,
    value: T,
) -> Result<(), E> {
    if slot.replace(value).is_some() {
        Err(E::custom(format_args!("{key}: given twice")))
    } else {
        Ok(())
    }
}

impl Values {
    /// Reads the value of a key that must be a parameter.
    fn take<'de, A: MapAccess<'de>>(
        &mut self,
        key: &str,
        map: &mut A,
        known: &KnownKeys,
    ) -> Result<(), A::Error> {
        let Some(index) = PARAMETERS.iter().position(|row| row.key == key) else {
            return Err(A::Error::custom(known.unknown(key)));
        };
        let key = PARAMETERS[index].key;
        once(key, &mut self.0[index], value_of(key, map)?)
    }
}

impl<'de> Deserialize<'de> for Values {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        keyed_object(deserializer)
    }
}

impl<'de> KeyedObject<'de> for Values {
    const EXPECTED: &'static str = "an object of parameters";

    fn take_key<A: MapAccess<'de>>(&mut self, key: &str, map: &mut A) -> Result<(), A::Error> {
        self.take(key, map, &SENSOR_KEYS)
    }
}

/// A text, borrowed if JSON needs no unescaping.
#[derive(Debug)]
pub struct Text<'a>(pub Cow<'a, str>);

impl<'de: 'a, 'a> Deserialize<'de> for Text<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TextVisitor;
        impl<'de> Visitor<'de> for TextVisitor {
            type Value = Text<'de>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a string")
            }
            fn visit_borrowed_str<E: Error>(self, text: &'de str) -> Result<Self::Value, E> {
                Ok(Text(Cow::Borrowed(text)))
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                Ok(Text(Cow::Owned(text.to_owned())))
            }
        }
        deserializer.deserialize_str(TextVisitor)
    }
}

impl<'de: 'a, 'a> Deserialize<'de> for ImprintOrName<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ContentVisitor;
        impl<'de> Visitor<'de> for ContentVisitor {
            type Value = ImprintOrName<'de>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(ROWS)
            }
            fn visit_borrowed_str<E: Error>(self, text: &'de str) -> Result<Self::Value, E> {
                Ok(ImprintOrName::Name(Cow::Borrowed(text)))
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                Ok(ImprintOrName::Name(Cow::Owned(text.to_owned())))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
                let ImprintRecord(imprint) = RowsVisitor.visit_seq(list)?;
                Ok(ImprintOrName::Imprint(Box::new(imprint)))
            }
        }
        deserializer.deserialize_any(ContentVisitor)
    }
}

/// An imprint as a list of its rows.
pub(crate) struct ImprintRecord(pub(crate) Imprint);

impl<'de> Deserialize<'de> for ImprintRecord {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(RowsVisitor)
    }
}

struct RowsVisitor;

impl<'de> Visitor<'de> for RowsVisitor {
    type Value = ImprintRecord;
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(ROWS)
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
        let mut rows = ImprintRows::default();
        while list.next_element_seed(NextRow(&mut rows))?.is_some() {}
        rows.imprint().map(ImprintRecord).map_err(A::Error::custom)
    }
}

/// The form of an imprint in JSON, for messages.
const ROWS: &str = "rows of '#' and '.'";

/// Parses the next row of an imprint in place, so that an error is reported at the row.
struct NextRow<'a>(&'a mut ImprintRows);

impl<'de> DeserializeSeed<'de> for NextRow<'_> {
    type Value = ();
    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_str(self)
    }
}

impl Visitor<'_> for NextRow<'_> {
    type Value = ();
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(ROWS)
    }
    fn visit_str<E: Error>(self, row: &str) -> Result<(), E> {
        self.0.push(row).map_err(E::custom)
    }
}
