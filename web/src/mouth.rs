use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use serde_json::Value;

use crate::{Digest, Message};

/// Sends messages, for the observer of a command and the watcher of its world.
#[derive(Clone)]
pub(crate) struct Mouth(Arc<Mutex<Telling>>);

/// Receives a message and its bytes.
type Tell = dyn FnMut(Message, &[u8]) + Send;

struct Telling {
    tell: Box<Tell>,
    digest: Digest,
    /// Simulated time (s).
    time: f64,
}

impl fmt::Debug for Mouth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Mouth").finish_non_exhaustive()
    }
}

impl Mouth {
    /// Speaks to the page.
    pub(crate) fn new(tell: impl FnMut(Message, &[u8]) + Send + 'static) -> Self {
        let telling = Telling { tell: Box::new(tell), digest: Digest::default(), time: 0.0 };
        Self(Arc::new(Mutex::new(telling)))
    }

    fn with<T>(&self, ask: impl FnOnce(&mut Telling) -> T) -> T {
        ask(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Sets the simulated time (s).
    pub(crate) fn set_time(&self, time: f64) {
        self.with(|telling| telling.time = time);
    }

    /// Sends a message.
    pub(crate) fn say(&self, message: Message, bytes: &[u8]) {
        self.with(|telling| {
            telling.digest.add(bytes);
            (telling.tell)(message, bytes);
        });
    }

    /// Sends a line of output, unless it was before a time (s).
    pub(crate) fn tell_line(&self, line: &str, from: f64) {
        let time = self.with(|telling| telling.time);
        if time >= from {
            self.say(Message::Told, &[&time.to_le_bytes(), line.as_bytes()].concat());
        }
    }

    /// Sends the end of the run: what [`Message::Ended`] has, but for the digest.
    pub(crate) fn end(&self, mut ended: Value) {
        let digest = self.with(|telling| {
            telling.digest.add(ended["output"].as_str().unwrap_or_default().as_bytes());
            telling.digest.to_string()
        });
        ended["digest"] = digest.into();
        self.say(Message::Ended, ended.to_string().as_bytes());
    }
}
