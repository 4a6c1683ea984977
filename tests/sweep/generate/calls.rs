//! Calls of all functions.

use std::fmt::Write as _;

use quote::ToTokens;
use syn::{FnArg, ReturnType};

use crate::source::{Crate, Function};
use crate::types::Known;

/// Writes the table of all functions.
pub(crate) fn write(crate_: &Crate, known: &Known) -> String {
    let mut text = String::from("/// All public functions.\npub static FUNCTIONS: &[Function] = &[\n");
    for function in &crate_.functions {
        let name = function.path.trim_start_matches("roverlab::");
        let call = match call(crate_, known, function) {
            Ok(call) => format!("Ok({call})"),
            Err(reason) => format!("Err({reason:?})"),
        };
        let _ = writeln!(text, "Function {{ name: {name:?}, panics: {}, call: {call} }},", function.panics);
    }
    text + "];\n"
}

/// A closure that calls a function, or the reason why there is none.
fn call(crate_: &Crate, known: &Known, function: &Function) -> Result<String, String> {
    if function.generic {
        return Err("generic".into());
    }
    let of = function.of.as_deref();
    let mut text = String::from("|picker: &mut Picker| {");
    let mut passed = Vec::new();
    for (k, input) in function.inputs.iter().enumerate() {
        let (sample, pass, suffix) = match input {
            FnArg::Receiver(receiver) => {
                let name = of.unwrap_or_default();
                if !known.0.contains(name) {
                    return Err(format!("no samples of {name}"));
                }
                let pass = match (&receiver.reference, receiver.mutability) {
                    (Some(_), Some(_)) => "&mut ",
                    (Some(_), None) => "&",
                    (None, _) => "",
                };
                (crate_.types[name].clone(), pass, "")
            }
            FnArg::Typed(input) => {
                let argument = known.argument(crate_, of, &input.ty).ok_or_else(|| {
                    format!("no samples of {}", input.ty.to_token_stream().to_string().replace(' ', ""))
                })?;
                (argument.sample, argument.pass, argument.suffix)
            }
        };
        let _ = write!(text, "let mut a{k} = picker.pick::<{sample}>()?;");
        passed.push(format!("{pass}a{k}{suffix}"));
    }
    let result = format!("{}({})", function.path, passed.join(", "));
    let output = match &function.output {
        ReturnType::Default => String::new(),
        ReturnType::Type(_, given) => given.to_token_stream().to_string(),
    };
    if output.starts_with("impl Iterator") || output.starts_with("impl DoubleEnded") {
        let _ = write!(text, "std::hint::black_box({result}.take(1_000_000).count()); Some(()) }}");
    } else {
        let _ = write!(text, "let _ = std::hint::black_box({result}); Some(()) }}");
    }
    Ok(text)
}
