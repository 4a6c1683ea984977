//! Types of arguments, and which of them have samples.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use quote::ToTokens;
use syn::{GenericArgument, Item, PathArguments, Type, TypeParamBound};

use crate::source::Crate;

/// Names of types with samples, and of those whose samples vary values that a file has.
pub(crate) struct Known(pub(crate) BTreeSet<String>, pub(crate) BTreeSet<String>);

/// Generic types whose samples are made of those of their parts.
const CONTAINERS: [&str; 4] = ["Vec", "Option", "Arc", "Box"];

/// How an argument is made: the type whose sample is picked, and the expression that passes it.
pub(crate) struct Argument {
    pub(crate) sample: String,
    pub(crate) pass: &'static str,
    pub(crate) suffix: &'static str,
}

impl Known {
    /// The types that are given samples in files.
    pub(crate) fn by_hand(files: &[PathBuf]) -> Self {
        let (mut names, mut varied) = (BTreeSet::new(), BTreeSet::new());
        for file in files {
            let text = fs::read_to_string(file).expect("samples");
            for line in text.lines() {
                if let Some((name, _)) = line.trim_start().split_once(" => [") {
                    names.insert(name.replace(' ', ""));
                } else if let Some((name, _)) = line.trim_start().split_once(" => varied [") {
                    varied.insert(name.into());
                }
            }
        }
        // Names of the library for types of other crates.
        for (own, other) in [
            ("Point", "Point2<f64>"),
            ("Vector", "Vector2<f64>"),
            ("Point3", "Point3<f64>"),
            ("Vector3", "Vector3<f64>"),
        ] {
            assert!(names.contains(other), "{other} has no samples");
            names.insert(own.into());
        }
        Self(names, varied)
    }

    /// How to make an argument of a type; `None` if that is not known.
    pub(crate) fn argument(&self, crate_: &Crate, of: Option<&str>, given: &Type) -> Option<Argument> {
        let plain =
            |pass, given: &Type| Some(Argument { sample: self.name(crate_, of, given)?, pass, suffix: "" });
        match given {
            Type::Reference(reference) => {
                let pass = if reference.mutability.is_some() { "&mut " } else { "&" };
                match &*reference.elem {
                    Type::Slice(slice) => {
                        let item = self.name(crate_, of, &slice.elem)?;
                        Some(Argument { sample: format!("Vec<{item}>"), pass, suffix: "" })
                    }
                    Type::Path(path) if path.path.is_ident("str") => {
                        Some(Argument { sample: "String".into(), pass: "&", suffix: "" })
                    }
                    Type::Path(path) if path.path.is_ident("Path") => {
                        Some(Argument { sample: "std::path::PathBuf".into(), pass: "&", suffix: "" })
                    }
                    inner => plain(pass, inner),
                }
            }
            Type::ImplTrait(bounds) => {
                let Some(TypeParamBound::Trait(bound)) = bounds.bounds.first() else { return None };
                let text = bound.to_token_stream().to_string().replace(' ', "");
                if text == "AsRef<Path>" || text == "Into<PathBuf>" {
                    return Some(Argument { sample: "std::path::PathBuf".into(), pass: "", suffix: "" });
                }
                if text.starts_with("Into<String>") || text.starts_with("Into<Cow<") {
                    return Some(Argument { sample: "String".into(), pass: "", suffix: "" });
                }
                let segment = bound.path.segments.last()?;
                let PathArguments::AngleBracketed(arguments) = &segment.arguments else { return None };
                match (segment.ident.to_string().as_str(), arguments.args.first()?) {
                    ("IntoIterator" | "Iterator", GenericArgument::AssocType(item)) => {
                        let item = self.name(crate_, of, &item.ty)?;
                        Some(Argument { sample: format!("Vec<{item}>"), pass: "", suffix: ".into_iter()" })
                    }
                    ("Into", GenericArgument::Type(inner)) => plain("", inner),
                    _ => None,
                }
            }
            Type::Path(path) if view_of(path).is_some() => {
                let (sample, suffix) = view_of(path)?;
                Some(Argument { sample: sample.into(), pass: "", suffix })
            }
            inner => plain("", inner),
        }
    }

    /// The full name of a type with samples.
    pub(crate) fn name(&self, crate_: &Crate, of: Option<&str>, given: &Type) -> Option<String> {
        match given {
            Type::Path(path) => {
                let last = path.path.segments.last()?;
                let name = last.ident.to_string();
                // That of the standard library, mostly, which has no samples.
                if path.path.segments.len() > 1 && name == "Error" {
                    return None;
                }
                if name == "Self" && path.path.segments.len() == 1 {
                    let of = of?;
                    return self.0.contains(of).then(|| crate_.types[of].clone());
                }
                match &last.arguments {
                    PathArguments::None => self.plain(crate_, &name),
                    PathArguments::AngleBracketed(arguments) => {
                        let parts: Option<Vec<String>> = arguments
                            .args
                            .iter()
                            .map(|part| match part {
                                GenericArgument::Type(inner) => self.name(crate_, of, inner),
                                _ => None,
                            })
                            .collect();
                        let full = match name.as_str() {
                            "Arc" => "std::sync::Arc",
                            "Range" => "std::ops::Range",
                            "RangeInclusive" => "std::ops::RangeInclusive",
                            other => other,
                        };
                        let text = format!("{full}<{}>", parts?.join(","));
                        (CONTAINERS.contains(&name.as_str()) || self.0.contains(&text)).then_some(text)
                    }
                    PathArguments::Parenthesized(_) => None,
                }
            }
            Type::Array(array) => {
                let (item, length) =
                    (self.name(crate_, of, &array.elem)?, array.len.to_token_stream().to_string());
                length.chars().all(|letter| letter.is_ascii_digit()).then(|| format!("[{item}; {length}]"))
            }
            Type::Tuple(tuple) if !tuple.elems.is_empty() => {
                let parts: Option<Vec<String>> =
                    tuple.elems.iter().map(|part| self.name(crate_, of, part)).collect();
                Some(format!("({},)", parts?.join(",")))
            }
            _ => None,
        }
    }

    fn plain(&self, crate_: &Crate, name: &str) -> Option<String> {
        if !self.0.contains(name) {
            return None;
        }
        let known = match name {
            "Point" | "Vector" | "Point3" | "Vector3" => format!("roverlab::geometry::{name}"),
            "Stream" => "roverlab::random::Stream".into(),
            _ => crate_.types.get(name).cloned().unwrap_or_else(|| name.into()),
        };
        Some(known)
    }
}

/// The buffer behind a view of an image, and the method that returns the view.
fn view_of(path: &syn::TypePath) -> Option<(&'static str, &'static str)> {
    match path.path.segments.last()?.ident.to_string().as_str() {
        "GrayView" => Some(("crate::samples::GrayBuffer", ".view()")),
        "RgbView" => Some(("crate::samples::RgbBuffer", ".view()")),
        "GrayViewMut" => Some(("crate::samples::GrayBuffer", ".view_mut()")),
        "RgbViewMut" => Some(("crate::samples::RgbBuffer", ".view_mut()")),
        _ => None,
    }
}

/// Whether a public item has neither parameters of types nor lifetimes.
pub(crate) fn is_concrete(item: &Item) -> bool {
    match item {
        Item::Struct(item) => item.generics.params.is_empty(),
        Item::Enum(item) => item.generics.params.is_empty(),
        _ => false,
    }
}
