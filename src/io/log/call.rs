use super::values::Values;
use super::wire::{Field, Fields, Reading};
use crate::io::{Error, ErrorKind};

/// A recorded call: the message `roverlab.Call`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Call<'a> {
    pub(super) method: &'a str,
    pub(super) arguments: Values,
    pub(super) result: std::result::Result<Values, Failure>,
}

/// A recorded error with its causes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Failure {
    kind: String,
    message: String,
    causes: Vec<String>,
}

/// Writes a call.
pub(super) fn write(
    out: &mut Vec<u8>,
    method: &str,
    arguments: &Values,
    result: std::result::Result<&Values, &Error>,
) {
    let mut call = Fields(out);
    call.text(1, method);
    arguments.write(&mut call, 2);
    match result {
        Ok(result) => result.write(&mut call, 3),
        Err(error) => call.message(4, |failure| {
            failure.text(1, &format!("{:?}", error.kind()));
            failure.text(2, &error.to_string());
            let mut cause = std::error::Error::source(error);
            while let Some(error) = cause {
                failure.text(3, &error.to_string());
                cause = error.source();
            }
        }),
    }
}

impl<'a> Call<'a> {
    /// `None` if the message is not a call.
    pub(super) fn read(message: &'a [u8]) -> Option<Self> {
        let mut call = Self { method: "", arguments: Values::default(), result: Ok(Values::default()) };
        let mut reading = Reading::new(message);
        for (number, field) in reading.by_ref() {
            match (number, field) {
                (1, Field::Bytes(method)) => call.method = str::from_utf8(method).ok()?,
                (2, Field::Bytes(values)) => call.arguments = Values::read(values)?,
                (3, Field::Bytes(values)) => call.result = Ok(Values::read(values)?),
                (4, Field::Bytes(failure)) => call.result = Err(Failure::read(failure)?),
                _ => {}
            }
        }
        (!reading.broken && !call.method.is_empty()).then_some(call)
    }
}

/// Text of a call, for messages.
pub(super) fn shown(method: &str, arguments: &Values) -> String {
    format!("{method}({})", arguments.shown())
}

impl Failure {
    fn read(message: &[u8]) -> Option<Self> {
        let mut failure = Self::default();
        let mut reading = Reading::new(message);
        for (number, field) in reading.by_ref() {
            let Field::Bytes(text) = field else { continue };
            let text = str::from_utf8(text).ok()?.to_owned();
            match number {
                1 => failure.kind = text,
                2 => failure.message = text,
                3 => failure.causes.push(text),
                _ => {}
            }
        }
        (!reading.broken).then_some(failure)
    }

    /// Restores the error.
    pub(super) fn error(&self) -> Error {
        let kinds = [
            ErrorKind::Unsupported,
            ErrorKind::Disconnected,
            ErrorKind::TimedOut,
            ErrorKind::InvalidInput,
            ErrorKind::EndOfLog,
            ErrorKind::Diverged,
        ];
        let kind =
            kinds.into_iter().find(|kind| format!("{kind:?}") == self.kind).unwrap_or(ErrorKind::Other);
        let error = Error::new(kind, &self.message);
        let causes = self.causes.iter().rev();
        let cause = causes.fold(None, |source, message| {
            Some(Cause { message: message.clone(), source: source.map(Box::new) })
        });
        match cause {
            Some(cause) => error.with_source(cause),
            None => error,
        }
    }
}

/// Cause of a recorded error.
#[derive(Debug)]
struct Cause {
    message: String,
    source: Option<Box<Cause>>,
}

impl std::fmt::Display for Cause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Cause {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.source.as_deref().map(|cause| cause as _)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_survives_with_its_causes() {
        let cause = Cause {
            message: "cable".into(),
            source: Some(Box::new(Cause { message: "dog".into(), source: None })),
        };
        let error = Error::new(ErrorKind::Disconnected, "no link").with_source(cause);
        let mut first = Vec::new();
        write(&mut first, "now", &Values::default(), Err(&error));
        let call = Call::read(&first).unwrap();
        let again = call.result.unwrap_err().error();
        assert_eq!((again.kind(), again.to_string().as_str()), (ErrorKind::Disconnected, "no link"));
        let mut second = Vec::new();
        write(&mut second, "now", &Values::default(), Err(&again));
        assert_eq!(first, second);
        for end in 0..first.len() {
            let _ = Call::read(&first[..end]);
        }
    }
}
