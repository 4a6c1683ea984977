use std::collections::{BTreeMap, VecDeque};
use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

use roverlab::io::Key;
use roverlab::io::log::Topic;
use serde_json::Value;

use super::outbox::{Outbox, deadline};
use super::protocol::{self, Wish};

/// Number of the page's channel, which every hub has.
pub(super) const PAGE: usize = 0;

/// Channels and their subscribers.
#[derive(Debug)]
pub(super) struct Hub {
    state: Mutex<State>,
    /// Wakes threads that wait for a subscription.
    subscribed: Condvar,
    /// Whether there are key presses not yet taken.
    pressed: AtomicBool,
    /// Number of subscriptions to the page's channel so far.
    pages: AtomicU64,
    source: OnceLock<Box<dyn Source>>,
    name: String,
    session: String,
}

/// Sends each client the channels that it subscribes to.
pub(super) trait Source: fmt::Debug + Send + Sync {
    /// A client has subscribed to a channel.
    fn subscribed(&self, hub: &Arc<Hub>, client: u64, subscription: u32, channel: usize, outbox: &Outbox);
}

#[derive(Debug, Default)]
struct State {
    channels: Vec<Advertised>,
    clients: BTreeMap<u64, Client>,
    joined: u64,
    keys: VecDeque<(usize, Key)>,
}

#[derive(Debug)]
struct Advertised {
    topic: Topic,
    channel: Channel,
    /// Messages for later clients: kind, time and content.
    kept: VecDeque<(u8, u64, Vec<u8>)>,
}

#[derive(Debug)]
struct Client {
    outbox: Outbox,
    /// Numbers of its subscriptions, with the channels.
    subscriptions: BTreeMap<u32, usize>,
    /// Numbers of the topics on which it presses keys, with the robots.
    keys: BTreeMap<u32, usize>,
}

/// A channel for messages.
#[derive(Debug, Clone)]
pub(super) struct Channel {
    id: usize,
    subscriptions: Arc<AtomicUsize>,
}

impl Channel {
    /// Whether somebody has subscribed to it.
    pub(super) fn is_wanted(&self) -> bool {
        self.subscriptions.load(Ordering::Relaxed) > 0
    }

    /// Whether it has this number.
    pub(super) fn is(&self, id: usize) -> bool {
        self.id == id
    }
}

/// Whether a message is also for later subscribers.
#[derive(Debug, Clone, Copy)]
pub(super) enum Keep {
    No,
    /// The last messages of a kind.
    Last(u8, usize),
}

/// Maximum number of pressed keys that wait.
const MOST_KEYS: usize = 100;

impl Hub {
    pub(super) fn new(name: String, session: String) -> Self {
        let hub = Self {
            state: Mutex::default(),
            subscribed: Condvar::new(),
            pressed: AtomicBool::new(false),
            pages: AtomicU64::new(0),
            source: OnceLock::new(),
            name,
            session,
        };
        hub.advertise(Topic { name: "/page".into(), schema: "roverlab.Page".into(), descriptor: Vec::new() });
        hub
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The page's channel.
    pub(super) fn page(&self) -> Channel {
        self.lock().channels[PAGE].channel.clone()
    }

    /// Number of times that a page has subscribed.
    pub(super) fn pages(&self) -> u64 {
        self.pages.load(Ordering::Relaxed)
    }

    pub(super) fn set_source(&self, source: Box<dyn Source>) {
        let _ = self.source.set(source);
    }

    /// The channel of a topic; a new one is announced.
    pub(super) fn advertise(&self, topic: Topic) -> Channel {
        let mut state = self.lock();
        if let Some(known) = state.channels.iter().find(|known| known.topic == topic) {
            return known.channel.clone();
        }
        let id = state.channels.len();
        let channel = Channel { id, subscriptions: Arc::default() };
        let message = protocol::advertise([(id, &topic)]);
        state.clients.values().for_each(|client| client.outbox.push(message.clone(), false));
        state.channels.push(Advertised { topic, channel: channel.clone(), kept: VecDeque::new() });
        channel
    }

    /// Sends a message at a time (ns).
    pub(super) fn publish(&self, channel: &Channel, time: u64, data: &[u8], keep: Keep) {
        let mut state = self.lock();
        for client in state.clients.values() {
            client.send(channel.id, time, data, matches!(keep, Keep::No));
        }
        if let Keep::Last(kind, most) = keep {
            let kept = &mut state.channels[channel.id].kept;
            kept.push_back((kind, time, data.to_vec()));
            if kept.iter().filter(|(other, ..)| *other == kind).count() > most
                && let Some(place) = kept.iter().position(|(other, ..)| *other == kind)
            {
                kept.remove(place);
            }
        }
    }

    /// Sends a message to one client. Returns whether it is still there.
    pub(super) fn deliver(&self, client: u64, channel: &Channel, time: u64, data: &[u8]) -> bool {
        let state = self.lock();
        let Some(client) = state.clients.get(&client) else { return false };
        client.send(channel.id, time, data, true);
        true
    }

    /// Sends the run's time (ns) to viewers other than the page.
    pub(super) fn tell_time(&self, time: u64) {
        self.lock().clients.values().for_each(|client| client.send_time(time));
    }

    /// The same to one client.
    pub(super) fn tell_time_to(&self, client: u64, time: u64) {
        if let Some(client) = self.lock().clients.get(&client) {
            client.send_time(time);
        }
    }

    /// Waits for a subscription.
    pub(super) fn wait_for_subscription(&self) {
        let mut state = self.lock();
        while state.clients.values().all(|client| client.subscriptions.is_empty()) {
            state = self.subscribed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Keys that have been pressed since the last call, with the robots.
    pub(super) fn take_keys(&self) -> VecDeque<(usize, Key)> {
        if self.pressed.swap(false, Ordering::Relaxed) {
            return std::mem::take(&mut self.lock().keys);
        }
        VecDeque::new()
    }

    /// Adds a client. Returns its number.
    pub(super) fn join(&self, outbox: &Outbox) -> u64 {
        let mut state = self.lock();
        outbox.push(protocol::server_info(&self.name, &self.session), false);
        let channels = state.channels.iter().map(|known| (known.channel.id, &known.topic));
        outbox.push(protocol::advertise(channels), false);
        state.joined += 1;
        let number = state.joined;
        let (subscriptions, keys) = (BTreeMap::new(), BTreeMap::new());
        state.clients.insert(number, Client { outbox: outbox.clone(), subscriptions, keys });
        number
    }

    /// Removes a client.
    pub(super) fn leave(&self, client: u64) {
        let mut state = self.lock();
        let Some(client) = state.clients.remove(&client) else { return };
        for channel in client.subscriptions.into_values() {
            state.channels[channel].channel.subscriptions.fetch_sub(1, Ordering::Relaxed);
        }
    }

    /// Ends all connections once everything has been sent, or after a time.
    pub(super) fn finish(&self, patience: Duration) {
        let outboxes: Vec<Outbox> =
            self.lock().clients.values().map(|client| client.outbox.clone()).collect();
        outboxes.iter().for_each(Outbox::close);
        let end = deadline(patience);
        for outbox in &outboxes {
            outbox.flush(end);
        }
    }

    /// Handles a client's message. The error says what was found and expected.
    pub(super) fn heed(self: &Arc<Self>, client: u64, wish: Wish) -> Result<(), String> {
        match wish {
            Wish::Subscribe(pairs) => {
                pairs.into_iter().try_for_each(|(id, channel)| self.subscribe(client, id, channel))
            }
            Wish::Unsubscribe(ids) => ids.into_iter().try_for_each(|id| self.unsubscribe(client, id)),
            Wish::Advertise(topics) => {
                topics.into_iter().try_for_each(|(id, topic)| self.add_keys(client, id, &topic))
            }
            Wish::Unadvertise(ids) => {
                if let Some(client) = self.lock().clients.get_mut(&client) {
                    client.keys.retain(|id, _| !ids.contains(id));
                }
                Ok(())
            }
            Wish::Data(id, data) => self.press(client, id, &data),
        }
    }

    fn subscribe(self: &Arc<Self>, number: u64, id: u32, channel: usize) -> Result<(), String> {
        let mut state = self.lock();
        let State { channels, clients, .. } = &mut *state;
        let Some(client) = clients.get_mut(&number) else { return Ok(()) };
        let Some(known) = channels.get(channel) else {
            return Err(format!(
                "subscription {id}: found no channel {channel}; expected one that was advertised"
            ));
        };
        if client.subscriptions.contains_key(&id) {
            return Err(format!("subscription {id}: there is one of this number; expected another"));
        }
        client.subscriptions.insert(id, channel);
        known.channel.subscriptions.fetch_add(1, Ordering::Relaxed);
        for (_, time, data) in &known.kept {
            client.outbox.push(protocol::message_data(id, *time, data), false);
        }
        if channel == PAGE {
            self.pages.fetch_add(1, Ordering::Relaxed);
        }
        let outbox = client.outbox.clone();
        drop(state);
        self.subscribed.notify_all();
        if let Some(source) = self.source.get() {
            source.subscribed(self, number, id, channel, &outbox);
        }
        Ok(())
    }

    fn unsubscribe(&self, client: u64, id: u32) -> Result<(), String> {
        let mut state = self.lock();
        let State { channels, clients, .. } = &mut *state;
        let Some(client) = clients.get_mut(&client) else { return Ok(()) };
        let channel =
            client.subscriptions.remove(&id).ok_or_else(|| format!("found no subscription {id}"))?;
        channels[channel].channel.subscriptions.fetch_sub(1, Ordering::Relaxed);
        Ok(())
    }

    fn add_keys(&self, client: u64, id: u32, topic: &str) -> Result<(), String> {
        let number = topic.strip_prefix("/robot").and_then(|rest| rest.strip_suffix("/keys")?.parse().ok());
        let robot = number.and_then(|number: usize| number.checked_sub(1));
        let robot = robot.ok_or_else(|| format!("found the topic {topic}; expected /robot1/keys"))?;
        if let Some(client) = self.lock().clients.get_mut(&client) {
            client.keys.insert(id, robot);
        }
        Ok(())
    }

    /// Presses the key of a message `{"key": 1}`.
    fn press(&self, client: u64, id: u32, data: &[u8]) -> Result<(), String> {
        let mut state = self.lock();
        let robot = state.clients.get(&client).and_then(|client| client.keys.get(&id).copied());
        let robot = robot
            .ok_or_else(|| format!("found a message on channel {id}; expected one that you advertised"))?;
        let message: Option<Value> = serde_json::from_slice(data).ok();
        let number = message.as_ref().and_then(|message| usize::try_from(message["key"].as_u64()?).ok());
        let key = number.and_then(|number| Key::ALL.get(number.checked_sub(1)?).copied());
        let key = key.ok_or_else(|| {
            format!("found {}; expected {{\"key\": 1}}, a number from 1 to 4", String::from_utf8_lossy(data))
        })?;
        if state.keys.len() == MOST_KEYS {
            return Err(format!("{MOST_KEYS} keys wait already; expected a run that goes on"));
        }
        state.keys.push_back((robot, key));
        self.pressed.store(true, Ordering::Relaxed);
        Ok(())
    }
}

impl Client {
    fn send(&self, channel: usize, time: u64, data: &[u8], droppable: bool) {
        for (&id, _) in self.subscriptions.iter().filter(|(_, other)| **other == channel) {
            self.outbox.push(protocol::message_data(id, time, data), droppable);
        }
    }

    fn send_time(&self, time: u64) {
        if self.subscriptions.values().any(|&channel| channel != PAGE) {
            self.outbox.push(protocol::time(time), true);
        }
    }
}
