use std::collections::BTreeMap;
use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use roverlab::io::log::{Log, Topic};

use super::hub::{Channel, Hub, PAGE, Source};
use super::outbox::{Outbox, now};
use super::protocol;
use super::server::{Opening, Server};
use crate::recorded;

/// The page and other viewers of a recording, until it is dropped.
#[derive(Debug)]
pub struct Player {
    server: Server,
}

impl Player {
    /// Listens for viewers of a recording. The page gets all of it at once and plays it by itself; others get
    /// each message at its time, from when they first subscribe. Fails if the port is taken.
    pub fn open(log: &Log, opening: &Opening) -> io::Result<Self> {
        let server = Server::open(opening)?;
        let mut channels: BTreeMap<Arc<Topic>, Channel> = BTreeMap::new();
        let messages = log.messages().map(|message| {
            let channel = channels
                .entry(message.topic)
                .or_insert_with_key(|topic| server.hub.advertise(Topic::clone(topic)));
            (message.time, channel.clone(), message.data)
        });
        let messages = messages.collect();
        let page = recorded::messages(log, &opening.command);
        server.hub.set_source(Box::new(Tape(Arc::new(Reel { messages, page, places: Mutex::default() }))));
        Ok(Self { server })
    }

    /// Address of the page; that of the protocol begins with `ws:`.
    pub fn address(&self) -> &str {
        self.server.address()
    }
}

#[derive(Debug, Clone)]
struct Tape(Arc<Reel>);

#[derive(Debug)]
struct Reel {
    /// All messages: time (ns), channel and content.
    messages: Vec<(u64, Channel, Vec<u8>)>,
    /// Messages to the page.
    page: Vec<Vec<u8>>,
    /// Number of messages played to a client.
    places: Mutex<BTreeMap<u64, usize>>,
}

impl Source for Tape {
    fn subscribed(&self, hub: &Arc<Hub>, client: u64, subscription: u32, channel: usize, outbox: &Outbox) {
        let (reel, hub, outbox) = (Arc::clone(&self.0), Arc::clone(hub), outbox.clone());
        if channel == PAGE {
            thread::spawn(move || reel.tell(subscription, &outbox));
            return;
        }
        let place = reel.places().get(&client).copied();
        if let Some(place) = place {
            reel.catch_up(place, channel, subscription, &outbox);
        } else {
            reel.places().insert(client, 0);
            thread::spawn(move || reel.play(&hub, client));
        }
    }
}

impl Reel {
    fn places(&self) -> MutexGuard<'_, BTreeMap<u64, usize>> {
        self.places.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sends a page all messages.
    fn tell(&self, subscription: u32, outbox: &Outbox) {
        for message in &self.page {
            if !outbox.push_patiently(protocol::message_data(subscription, 0, message)) {
                return;
            }
        }
    }

    /// Plays the messages at their times, until the client has left.
    fn play(&self, hub: &Hub, client: u64) {
        let begin = now();
        let first = self.messages.first().map_or(0, |(time, ..)| *time);
        for (place, (time, channel, data)) in self.messages.iter().enumerate() {
            let due = Duration::from_nanos(time - first.min(*time));
            thread::sleep(due.saturating_sub(now() - begin));
            hub.tell_time_to(client, *time);
            self.places().insert(client, place + 1);
            if !hub.deliver(client, channel, *time, data) {
                break;
            }
        }
    }

    /// The first and the last message so far of a channel, for a later subscription.
    fn catch_up(&self, place: usize, channel: usize, subscription: u32, outbox: &Outbox) {
        let mut past = self.messages[..place].iter().filter(|(_, other, _)| other.is(channel));
        let (first, last) = (past.next(), past.next_back());
        for (time, _, data) in first.into_iter().chain(last) {
            outbox.push(protocol::message_data(subscription, *time, data), false);
        }
    }
}
