//! Foxglove's WebSocket protocol, version 1: texts are JSON with the field `op`, data is binary.

use data_encoding::BASE64;
use roverlab::io::log::Topic;
use serde_json::{Value, json};
use tungstenite::protocol::frame::Frame;
use tungstenite::protocol::frame::coding::{Data, OpCode};

/// Names of the protocol: the original one, and that of newer programs, which has the same messages.
pub(super) const NAMES: [&str; 2] = ["foxglove.websocket.v1", "foxglove.sdk.v1"];

/// Kind of a binary message: data from the server, time, and data from a client.
const MESSAGE_DATA: u8 = 1;
const TIME: u8 = 2;
const CLIENT_DATA: u8 = 1;

/// A text as WebSocket frame.
fn text(value: &Value) -> Vec<u8> {
    framed(OpCode::Data(Data::Text), value.to_string().into_bytes())
}

fn framed(kind: OpCode, payload: Vec<u8>) -> Vec<u8> {
    let mut out = Vec::with_capacity(payload.len() + 10);
    // Writing to a vector cannot fail.
    let _ = Frame::message(payload, kind, true).format(&mut out);
    out
}

/// The end of a connection.
pub(super) fn close() -> Vec<u8> {
    let mut out = Vec::new();
    // Writing to a vector cannot fail.
    let _ = Frame::close(None).format(&mut out);
    out
}

pub(super) fn server_info(name: &str, session: &str) -> Vec<u8> {
    text(&json!({
        "op": "serverInfo", "name": name, "capabilities": ["clientPublish", "time"],
        "supportedEncodings": ["json"], "metadata": {}, "sessionId": session,
    }))
}

/// Announces channels, given by their numbers and topics.
pub(super) fn advertise<'a>(channels: impl IntoIterator<Item = (usize, &'a Topic)>) -> Vec<u8> {
    let channels = channels.into_iter().map(|(id, Topic { name, schema, descriptor })| {
        // The page's own messages have no schema.
        let encoding = if descriptor.is_empty() { "roverlab" } else { "protobuf" };
        let mut channel = json!({
            "id": id, "topic": name, "encoding": encoding, "schemaName": schema, "schema": BASE64.encode(descriptor),
        });
        if !descriptor.is_empty() {
            channel["schemaEncoding"] = "protobuf".into();
        }
        channel
    });
    text(&json!({ "op": "advertise", "channels": channels.collect::<Vec<_>>() }))
}

/// A warning.
pub(super) fn status(message: &str) -> Vec<u8> {
    text(&json!({ "op": "status", "level": 1, "message": message }))
}

/// A message on a subscription, at a time (ns).
pub(super) fn message_data(subscription: u32, time: u64, data: &[u8]) -> Vec<u8> {
    let mut payload = Vec::with_capacity(data.len() + 13);
    payload.push(MESSAGE_DATA);
    payload.extend_from_slice(&subscription.to_le_bytes());
    payload.extend_from_slice(&time.to_le_bytes());
    payload.extend_from_slice(data);
    framed(OpCode::Data(Data::Binary), payload)
}

/// The run's time (ns).
pub(super) fn time(time: u64) -> Vec<u8> {
    let payload = [&[TIME][..], &time.to_le_bytes()].concat();
    framed(OpCode::Data(Data::Binary), payload)
}

/// A message of a client.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Wish {
    /// Subscriptions: their numbers and those of the channels.
    Subscribe(Vec<(u32, usize)>),
    Unsubscribe(Vec<u32>),
    /// Topics on which the client will publish, and their numbers.
    Advertise(Vec<(u32, String)>),
    Unadvertise(Vec<u32>),
    /// Data on one of them.
    Data(u32, Vec<u8>),
}

impl Wish {
    /// A text message. The error says what was found and expected.
    pub(super) fn of_text(text: &str) -> Result<Self, String> {
        let wish: Value = serde_json::from_str(text).map_err(|error| format!("found no JSON: {error}"))?;
        let wrong = || format!("found {wish}; expected an operation of {}", NAMES[0]);
        let pairs = |list: &str, of: fn(&Value) -> Option<(u32, &Value)>| {
            let pairs = wish[list].as_array()?.iter().map(of).collect::<Option<Vec<_>>>()?;
            Some(pairs)
        };
        let numbers = |list: &str| {
            wish[list].as_array()?.iter().map(|id| u32::try_from(id.as_u64()?).ok()).collect::<Option<_>>()
        };
        let found = match wish["op"].as_str() {
            Some("subscribe") => {
                pairs("subscriptions", |item| Some((number(&item["id"])?, &item["channelId"])))
                    .and_then(|pairs| {
                        let channel = |channel: &Value| usize::try_from(channel.as_u64()?).ok();
                        pairs.into_iter().map(|(id, value)| Some((id, channel(value)?))).collect()
                    })
                    .map(Self::Subscribe)
            }
            Some("unsubscribe") => numbers("subscriptionIds").map(Self::Unsubscribe),
            Some("advertise") => pairs("channels", |item| Some((number(&item["id"])?, &item["topic"])))
                .and_then(|pairs| {
                    pairs.into_iter().map(|(id, topic)| Some((id, topic.as_str()?.to_owned()))).collect()
                })
                .map(Self::Advertise),
            Some("unadvertise") => numbers("channelIds").map(Self::Unadvertise),
            _ => None,
        };
        found.ok_or_else(wrong)
    }

    /// Binary data.
    pub(super) fn of_data(data: &[u8]) -> Result<Self, String> {
        match data {
            [CLIENT_DATA, a, b, c, d, payload @ ..] => {
                Ok(Self::Data(u32::from_le_bytes([*a, *b, *c, *d]), payload.to_vec()))
            }
            _ => Err(format!(
                "found {} bytes that begin with {:?}; expected {CLIENT_DATA}, the channel and a message",
                data.len(),
                data.first()
            )),
        }
    }
}

fn number(value: &Value) -> Option<u32> {
    u32::try_from(value.as_u64()?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wishes_are_read_or_refused() {
        let subscribe = r#"{"op":"subscribe","subscriptions":[{"id":7,"channelId":2}]}"#;
        assert_eq!(Wish::of_text(subscribe), Ok(Wish::Subscribe(vec![(7, 2)])));
        let advertise =
            r#"{"op":"advertise","channels":[{"id":1,"topic":"/robot1/keys","encoding":"json"}]}"#;
        assert_eq!(Wish::of_text(advertise), Ok(Wish::Advertise(vec![(1, "/robot1/keys".into())])));
        assert_eq!(Wish::of_data(&[1, 1, 0, 0, 0, 9]), Ok(Wish::Data(1, vec![9])));
        for text in
            ["", "{}", r#"{"op":"fly"}"#, r#"{"op":"subscribe","subscriptions":[{"id":-1,"channelId":2}]}"#]
        {
            assert!(Wish::of_text(text).is_err(), "{text}");
        }
        assert!(Wish::of_data(&[]).is_err() && Wish::of_data(&[2, 0, 0, 0, 0]).is_err());
    }
}
