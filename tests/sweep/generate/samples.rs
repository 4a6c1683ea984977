//! Samples of types, made of those of their public fields or by their constructors.

use std::fmt::Write as _;

use syn::{Field, Fields, FnArg, GenericArgument, Item, PathArguments, ReturnType, Type, Visibility};

use crate::source::{Crate, Function};
use crate::types::{Argument, Known, is_concrete};

/// Derives the samples of all types that can be made of known ones, until there are no more.
pub(crate) fn derive(crate_: &Crate, known: &mut Known) -> String {
    let mut text = String::new();
    // Values that a file has are varied in all fields that have samples: those of all others come first.
    let mut others = true;
    loop {
        let before = known.0.len();
        for (name, item) in &crate_.definitions {
            if known.0.contains(name) || !is_concrete(item) || is_open(item) {
                continue;
            }
            if others && known.1.contains(name) && !all_known(crate_, known, item) {
                continue;
            }
            if let Some(implementation) = implementation(crate_, known, name, item) {
                text += &implementation;
                known.0.insert(name.clone());
            }
        }
        if known.0.len() != before {
            others = true;
        } else if !std::mem::replace(&mut others, false) {
            return text;
        }
    }
}

/// Whether all fields of a structure have samples.
fn all_known(crate_: &Crate, known: &Known, item: &Item) -> bool {
    let Item::Struct(item) = item else { return false };
    item.fields.iter().all(|field| known.name(crate_, None, &field.ty).is_some())
}

fn implementation(crate_: &Crate, known: &Known, name: &str, item: &Item) -> Option<String> {
    let path = &crate_.types[name];
    match item {
        Item::Struct(item) => {
            let fields: Vec<&Field> = item.fields.iter().collect();
            let all_public = fields.iter().all(|field| matches!(field.vis, Visibility::Public(_)));
            if all_public && matches!(item.fields, Fields::Named(_)) {
                return structure(crate_, known, name, path, &fields);
            }
            constructed(crate_, known, name, path)
        }
        Item::Enum(item) => {
            let mut variants = Vec::new();
            for variant in &item.variants {
                let types: Option<Vec<String>> =
                    variant.fields.iter().map(|field| known.name(crate_, Some(name), &field.ty)).collect();
                let types = types?;
                let picks = |(k, field): (usize, &Field)| match &field.ident {
                    Some(name) => format!("{name}: picker.pick::<{}>()?", types[k]),
                    None => format!("picker.pick::<{}>()?", types[k]),
                };
                let picks: Vec<String> = variant.fields.iter().enumerate().map(picks).collect();
                let make = match variant.fields {
                    Fields::Unit => String::new(),
                    Fields::Named(_) => format!("{{ {} }}", picks.join(", ")),
                    Fields::Unnamed(_) => format!("({})", picks.join(", ")),
                };
                variants.push((counts(&types), format!("{path}::{}{make}", variant.ident)));
            }
            Some(enumeration(path, &variants))
        }
        _ => None,
    }
}

/// An array of the numbers of samples of types.
fn counts(types: &[String]) -> String {
    let counts: Vec<String> = types.iter().map(|name| format!("<{name} as Sample>::count()")).collect();
    format!("&[{}]", counts.join(", "))
}

fn wrap(path: &str, count: &str, nth: &str) -> String {
    format!(
        "impl Sample for {path} {{\n    fn count() -> usize {{ {count} }}\n    fn nth(index: usize) -> Option<Self> {{ {nth} }}\n}}\n"
    )
}

/// A structure whose fields are all public: as a file has it, as it is by default, or of first samples, but
/// for one field.
fn structure(crate_: &Crate, known: &Known, name: &str, path: &str, fields: &[&Field]) -> Option<String> {
    let varied = known.1.contains(name);
    let default = varied || crate_.defaults.contains(name);
    let named: Vec<(String, Option<String>)> = fields
        .iter()
        .map(|field| {
            let name = field.ident.as_ref().expect("a named field").to_string();
            (name, known.name(crate_, Some(name_of(path)), &field.ty))
        })
        .collect();
    if !default {
        let types: Option<Vec<String>> = named.iter().map(|(_, given)| given.clone()).collect();
        let types = types?;
        let picks: Vec<String> = named
            .iter()
            .zip(&types)
            .map(|((name, _), given)| format!("{name}: picker.pick::<{given}>()?"))
            .collect();
        let counts = counts(&types);
        let nth =
            format!("let mut picker = Picker::nth(index, {counts}); Some({path} {{ {} }})", picks.join(", "));
        return Some(wrap(path, &format!("Picker::total({counts})"), &nth));
    }
    let bases = format!("<{path} as crate::sample::Varied>::COUNT");
    let first = if varied {
        format!(
            "let mut made = <{path} as crate::sample::Varied>::base(index % {bases}); let index = index / {bases};"
        )
    } else {
        format!("let mut made = <{path}>::default();")
    };
    let mut nth = format!("{first} if index == 0 {{ return Some(made); }} let mut index = index - 1;");
    let mut count = String::from("1");
    for (field, given) in named {
        let Some(given) = given else { continue };
        let _ = write!(count, " + <{given} as Sample>::count()");
        let _ = writeln!(
            nth,
            "if index < <{given} as Sample>::count() {{ made.{field} = <{given} as Sample>::nth(index)?; return Some(made); }} \
             index -= <{given} as Sample>::count();"
        );
    }
    nth += "None";
    let count = if varied { format!("{bases} * ({count})") } else { count };
    Some(wrap(path, &count, &nth))
}

fn name_of(path: &str) -> &str {
    path.rsplit("::").next().unwrap_or(path)
}

fn enumeration(path: &str, variants: &[(String, String)]) -> String {
    let count: Vec<String> = variants.iter().map(|(counts, _)| format!("Picker::total({counts})")).collect();
    let mut nth = String::from("let mut index = index;");
    for (counts, make) in variants {
        let _ = writeln!(
            nth,
            "if index < Picker::total({counts}) {{ let mut picker = Picker::nth(index, {counts}); return Some({make}); }} \
             index -= Picker::total({counts});"
        );
    }
    nth += "None";
    wrap(path, &count.join(" + "), &nth)
}

/// How the returned value becomes the type itself.
fn made(name: &str, output: &ReturnType) -> Option<&'static str> {
    let ReturnType::Type(_, given) = output else { return None };
    let is_self = |given: &Type| {
        let Type::Path(path) = given else { return false };
        path.path
            .segments
            .last()
            .is_some_and(|last| last.arguments.is_none() && (last.ident == "Self" || last.ident == name))
    };
    if is_self(given) {
        return Some("Some(made)");
    }
    let Type::Path(path) = &**given else { return None };
    let last = path.path.segments.last()?;
    let PathArguments::AngleBracketed(arguments) = &last.arguments else { return None };
    let Some(GenericArgument::Type(inner)) = arguments.args.first() else { return None };
    match last.ident.to_string().as_str() {
        "Result" if is_self(inner) => Some("made.ok()"),
        "Option" if is_self(inner) => Some("made"),
        _ => None,
    }
}

fn arguments(crate_: &Crate, known: &Known, function: &Function) -> Option<Vec<Argument>> {
    let of = function.of.as_deref();
    let argument = |input: &FnArg| match input {
        FnArg::Receiver(_) => None,
        FnArg::Typed(input) => known.argument(crate_, of, &input.ty),
    };
    function.inputs.iter().map(argument).collect()
}

/// A type with private fields: what its constructor with the most arguments makes, else what it is by default.
fn constructed(crate_: &Crate, known: &Known, name: &str, path: &str) -> Option<String> {
    let constructors = crate_.functions.iter().filter(|function| {
        function.of.as_deref() == Some(name) && !function.generic && made(name, &function.output).is_some()
    });
    let candidates =
        constructors.filter_map(|function| Some((function, arguments(crate_, known, function)?)));
    let is_new = |function: &Function| function.path.ends_with("::new");
    let best = candidates.max_by_key(|(function, arguments)| (is_new(function), arguments.len()));
    let (function, arguments) = match best {
        Some((function, arguments)) if !arguments.is_empty() => (function, arguments),
        _ if crate_.defaults.contains(name) => {
            return Some(wrap(path, "1", &format!("Some(<{path}>::default())")));
        }
        other => {
            let (function, _) = other?;
            let nth = format!("let made = {}(); {}", function.path, made(name, &function.output)?);
            return Some(wrap(path, "1", &nth));
        }
    };
    let types: Vec<String> = arguments.iter().map(|argument| argument.sample.clone()).collect();
    let counts = counts(&types);
    let mut nth = format!("let mut picker = Picker::nth(index, {counts});");
    for (k, given) in types.iter().enumerate() {
        let _ = write!(nth, "let mut a{k} = picker.pick::<{given}>()?;");
    }
    let passed: Vec<String> = arguments
        .iter()
        .enumerate()
        .map(|(k, argument)| format!("{}a{k}{}", argument.pass, argument.suffix))
        .collect();
    let _ =
        write!(nth, "let made = {}({}); {}", function.path, passed.join(", "), made(name, &function.output)?);
    Some(wrap(path, &format!("Picker::total({counts})"), &nth))
}

/// Whether other crates cannot write a value of a type.
fn is_open(item: &Item) -> bool {
    let Item::Struct(item) = item else { return false };
    item.attrs.iter().any(|attribute| attribute.path().is_ident("non_exhaustive"))
}
