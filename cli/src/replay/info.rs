use roverlab::io::log::{Log, SCHEMA_VERSION};
use serde_json::json;

use super::Found;
use crate::common::Failure;

/// Content of a recording.
#[allow(clippy::unnecessary_wraps, reason = "as the other commands")]
pub(super) fn info(log: &Log) -> Result<Found, Failure> {
    let header = log.header();
    let (start, end) = log.span().unwrap_or_default();
    let attachments: Vec<_> = header
        .attachments
        .iter()
        .map(|file| json!({ "name": file.name, "bytes": file.data.len() }))
        .collect();
    let fields = json!({
        "example": "replay", "command": "info", "outcome": "read",
        "program": header.program, "version": header.version, "schema": SCHEMA_VERSION, "seed": header.seed,
        "options": header.options, "robots": log.robots(), "start_s": start, "end_s": end,
        "bytes": log.bytes().len(), "chunks": log.chunks(), "topics": log.topics(), "attachments": attachments,
        "attachments_hash": format!("{:016x}", header.digest()),
        "attachments_lost": log.lacks_attachments(), "compression": header.compression.name(),
    });
    let mut lines = vec![format!("{} {}", header.program, header.options.join(" "))];
    let mut add = |name: &str, value: String| lines.push(format!("  {name:<22} {value}"));
    add("made by", format!("roverlab {}", header.version));
    add("robots", log.robots().to_string());
    add("time", format!("{start:.3} to {end:.3} s"));
    add("size", format!("{} bytes in {} chunks", log.bytes().len(), log.chunks()));
    for (topic, messages) in log.topics() {
        add(topic, format!("{messages} messages"));
    }
    for file in &header.attachments {
        add(&file.name, format!("{} bytes", file.data.len()));
    }
    if log.lacks_attachments() {
        lines.push("  some attachments are lost".into());
    }
    Ok(Found { fields, text: lines.join("\n"), good: true, warning: None })
}
