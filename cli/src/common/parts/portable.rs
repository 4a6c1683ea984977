use serde_json::{Map, Value};

/// A result that keeps every bit in the JSON of a part's file, numbers that are not finite included.
///
/// `portable!(struct Trial { seed, error })` implements it for structs of portable fields, and
/// `portable!(enum Verdict { Good, Bad })` for enums of plain variants, also for those of the library.
pub(crate) trait Portable: Sized {
    /// The result as JSON.
    fn packed(&self) -> Value;

    /// The result in some JSON. Fails with what was found and what was expected.
    fn unpacked(value: &Value) -> Result<Self, String>;
}

/// Implements [`Portable`].
macro_rules! portable {
    (struct $type:ty { $($field:ident),* $(,)? }) => {
        impl $crate::common::Portable for $type {
            fn packed(&self) -> serde_json::Value {
                let mut object = serde_json::Map::new();
                $(object.insert(stringify!($field).into(), $crate::common::Portable::packed(&self.$field));)*
                object.into()
            }

            fn unpacked(value: &serde_json::Value) -> Result<Self, String> {
                let object = $crate::common::fields(value, &[$(stringify!($field)),*])?;
                Ok(Self { $($field: $crate::common::field(object, stringify!($field))?),* })
            }
        }
    };
    (enum $type:ty { $($variant:ident),* $(,)? }) => {
        impl $crate::common::Portable for $type {
            fn packed(&self) -> serde_json::Value {
                // The name of a plain variant.
                format!("{self:?}").into()
            }

            fn unpacked(value: &serde_json::Value) -> Result<Self, String> {
                match value.as_str() {
                    $(Some(stringify!($variant)) => Ok(Self::$variant),)*
                    _ => {
                        let names: &[&str] = &[$(stringify!($variant)),*];
                        Err($crate::common::unexpected(value, &format!("one of {}", names.join(", "))))
                    }
                }
            }
        }
    };
}

pub(crate) use portable;

/// Characters shown of a wrong value.
const SHOWN: usize = 40;

/// The message for a value of the wrong kind.
pub(crate) fn unexpected(value: &Value, expected: &str) -> String {
    let text = match value {
        Value::Array(_) => "a list".to_owned(),
        Value::Object(_) => "an object".to_owned(),
        Value::String(text) => format!("{:?}", text.chars().take(SHOWN).collect::<String>()),
        other => other.to_string(),
    };
    format!("found {text}, expected {expected}")
}

/// The fields of an object that has exactly those.
pub(crate) fn fields<'a>(value: &'a Value, names: &[&str]) -> Result<&'a Map<String, Value>, String> {
    let object = value.as_object().ok_or_else(|| unexpected(value, "an object"))?;
    match object.keys().find(|key| !names.contains(&key.as_str())) {
        Some(key) => Err(format!(
            "found the field {:?}, expected {}",
            key.chars().take(SHOWN).collect::<String>(),
            names.join(", ")
        )),
        None => Ok(object),
    }
}

/// A field of an object.
pub(crate) fn field<T: Portable>(object: &Map<String, Value>, name: &str) -> Result<T, String> {
    let value = object.get(name).ok_or_else(|| format!("found no field {name}, expected one"))?;
    T::unpacked(value).map_err(|error| format!("{name}: {error}"))
}

/// Numbers that JSON lacks: infinite ones by name, the others by their bits.
impl Portable for f64 {
    fn packed(&self) -> Value {
        match *self {
            Self::INFINITY => "inf".into(),
            Self::NEG_INFINITY => "-inf".into(),
            value if value.is_nan() => format!("nan:{:016x}", value.to_bits()).into(),
            value => value.into(),
        }
    }

    fn unpacked(value: &Value) -> Result<Self, String> {
        let named = |text: &str| match text {
            "inf" => Some(Self::INFINITY),
            "-inf" => Some(Self::NEG_INFINITY),
            _ => {
                let bits = u64::from_str_radix(text.strip_prefix("nan:")?, 16).ok()?;
                Some(Self::from_bits(bits)).filter(|number| number.is_nan())
            }
        };
        let number = value.as_f64().or_else(|| named(value.as_str()?));
        number.ok_or_else(|| unexpected(value, "a number, \"inf\", \"-inf\" or the bits of a \"nan:\""))
    }
}

macro_rules! whole_numbers {
    ($($number:ty)*) => {$(
        impl Portable for $number {
            fn packed(&self) -> Value {
                serde_json::json!(*self)
            }

            fn unpacked(value: &Value) -> Result<Self, String> {
                let number = value.as_u64().and_then(|number| Self::try_from(number).ok());
                number.ok_or_else(|| unexpected(value, &format!("a whole number up to {}", Self::MAX)))
            }
        }
    )*};
}

whole_numbers!(u32 u64 usize);

impl Portable for bool {
    fn packed(&self) -> Value {
        (*self).into()
    }

    fn unpacked(value: &Value) -> Result<Self, String> {
        value.as_bool().ok_or_else(|| unexpected(value, "true or false"))
    }
}

impl Portable for String {
    fn packed(&self) -> Value {
        self.as_str().into()
    }

    fn unpacked(value: &Value) -> Result<Self, String> {
        value.as_str().map(str::to_owned).ok_or_else(|| unexpected(value, "a text"))
    }
}

/// `null` is `None`, so an option of an option would lose one.
impl<T: Portable> Portable for Option<T> {
    fn packed(&self) -> Value {
        self.as_ref().map_or(Value::Null, Portable::packed)
    }

    fn unpacked(value: &Value) -> Result<Self, String> {
        if value.is_null() { Ok(None) } else { T::unpacked(value).map(Some) }
    }
}

/// A result or an error: a pair of which one is null.
impl<T: Portable + Clone> Portable for Result<T, String> {
    fn packed(&self) -> Value {
        (self.as_ref().ok().cloned(), self.as_ref().err().cloned()).packed()
    }

    fn unpacked(value: &Value) -> Result<Self, String> {
        match Portable::unpacked(value)? {
            (Some(outcome), None) => Ok(Ok(outcome)),
            (None, Some(error)) => Ok(Err(error)),
            _ => Err(unexpected(value, "either an outcome or an error")),
        }
    }
}

impl<T: Portable> Portable for Vec<T> {
    fn packed(&self) -> Value {
        self.iter().map(Portable::packed).collect()
    }

    fn unpacked(value: &Value) -> Result<Self, String> {
        let items = value.as_array().ok_or_else(|| unexpected(value, "a list"))?;
        items.iter().map(T::unpacked).collect()
    }
}

impl<T: Portable, const N: usize> Portable for [T; N] {
    fn packed(&self) -> Value {
        self.iter().map(Portable::packed).collect()
    }

    fn unpacked(value: &Value) -> Result<Self, String> {
        let items = Vec::<T>::unpacked(value)?;
        let found = items.len();
        items.try_into().map_err(|_| format!("found a list of {found}, expected one of {N}"))
    }
}

macro_rules! tuples {
    ($(($($part:ident $index:tt),*) of $count:literal)*) => {$(
        impl<$($part: Portable),*> Portable for ($($part,)*) {
            fn packed(&self) -> Value {
                Value::Array(vec![$(self.$index.packed()),*])
            }

            fn unpacked(value: &Value) -> Result<Self, String> {
                match value.as_array() {
                    Some(items) if items.len() == $count => Ok(($($part::unpacked(&items[$index])?,)*)),
                    _ => Err(unexpected(value, concat!("a list of ", $count))),
                }
            }
        }
    )*};
}

tuples!((A 0, B 1) of 2 (A 0, B 1, C 2) of 3);
