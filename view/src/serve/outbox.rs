use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::protocol;

/// Maximum number of bytes that wait for a client.
const MOST: usize = 16 << 20;

/// WebSocket frames on their way to a client. Copies share the queue.
#[derive(Debug, Clone, Default)]
pub(super) struct Outbox(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    queue: Mutex<Queue>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Queue {
    /// Frames, each with a flag whether it may be dropped.
    frames: VecDeque<(Vec<u8>, bool)>,
    bytes: usize,
    dropped: u64,
    /// Whether a frame is being sent.
    sending: bool,
    /// Whether it is closed.
    closed: bool,
}

impl Queue {
    /// Drops the oldest frame that may be dropped; otherwise the oldest one.
    fn drop_one(&mut self) {
        let place = self.frames.iter().position(|(_, droppable)| *droppable).unwrap_or(0);
        if let Some((frame, _)) = self.frames.remove(place) {
            self.bytes -= frame.len();
            self.dropped += 1;
        }
    }

    fn add(&mut self, frame: Vec<u8>, droppable: bool) {
        self.bytes += frame.len();
        self.frames.push_back((frame, droppable));
    }
}

impl Outbox {
    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.0.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a frame, in the place of the oldest ones if the client is too slow. Never waits.
    pub(super) fn push(&self, frame: Vec<u8>, droppable: bool) {
        let mut queue = self.lock();
        if queue.closed {
            return;
        }
        queue.add(frame, droppable);
        while queue.bytes > MOST && queue.frames.len() > 1 {
            queue.drop_one();
        }
        self.0.changed.notify_all();
    }

    /// Adds a frame once there is room. Returns whether the client is still there.
    pub(super) fn push_patiently(&self, frame: Vec<u8>) -> bool {
        let mut queue = self.lock();
        while queue.bytes > MOST && !queue.closed {
            queue = self.0.changed.wait(queue).unwrap_or_else(PoisonError::into_inner);
        }
        if !queue.closed {
            queue.add(frame, false);
            self.0.changed.notify_all();
        }
        !queue.closed
    }

    /// The next frame; waits for it. `None` after the last one.
    pub(super) fn next(&self) -> Option<Vec<u8>> {
        let mut queue = self.lock();
        queue.sending = false;
        self.0.changed.notify_all();
        loop {
            if queue.dropped > 0 {
                let dropped = std::mem::take(&mut queue.dropped);
                return Some(protocol::status(&format!(
                    "{dropped} messages were dropped: they came faster than they were read"
                )));
            }
            if let Some((frame, _)) = queue.frames.pop_front() {
                queue.bytes -= frame.len();
                queue.sending = true;
                return Some(frame);
            }
            if queue.closed {
                return None;
            }
            queue = self.0.changed.wait(queue).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Closes it: the client receives the rest of the queue.
    pub(super) fn close(&self) {
        self.push(protocol::close(), false);
        self.lock().closed = true;
        self.0.changed.notify_all();
    }

    /// The client has left.
    pub(super) fn abandon(&self) {
        let mut queue = self.lock();
        *queue = Queue { closed: true, ..Queue::default() };
        self.0.changed.notify_all();
    }

    /// Waits until everything has been sent, up to a time.
    pub(super) fn flush(&self, end: Instant) {
        let mut queue = self.lock();
        while !queue.frames.is_empty() || queue.sending {
            let left = end.saturating_duration_since(now());
            if left.is_zero() {
                return;
            }
            queue = self.0.changed.wait_timeout(queue, left).unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

#[allow(clippy::disallowed_methods, reason = "connections take real time; no result depends on it")]
pub(super) fn now() -> Instant {
    Instant::now()
}

pub(super) fn deadline(patience: Duration) -> Instant {
    now() + patience
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_client_misses_the_oldest_and_is_told() {
        let outbox = Outbox::default();
        outbox.push(vec![0], false);
        for number in 1..=40 {
            outbox.push(vec![number; 1 << 20], true);
        }
        assert!(outbox.lock().bytes <= MOST);
        let first = outbox.next().unwrap();
        assert!(String::from_utf8_lossy(&first).contains("25 messages were dropped"), "{}", first.len());
        assert_eq!(outbox.next(), Some(vec![0]), "what must not be dropped is still there");
        assert_eq!(outbox.next().unwrap()[0], 26);
        outbox.close();
        let rest = std::iter::from_fn(|| outbox.next()).count();
        assert_eq!(rest, 15, "and the end of the connection");
    }
}
