//! The encoding of ROS's messages: CDR behind four bytes that say which kind.

use byteorder::{BigEndian, LittleEndian};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The kinds of CDR that ROS 2 writes: big-endian and little-endian; options that nobody uses follow.
const BIG: [u8; 2] = [0, 0];
/// Little-endian.
const LITTLE: [u8; 2] = [0, 1];

/// A message in little-endian CDR.
pub(super) fn encoded(message: &impl Serialize) -> Vec<u8> {
    let body = cdr_encoding::to_vec::<_, LittleEndian>(message);
    // Only lists of unknown length and maps cannot be encoded, and no message has any.
    [&LITTLE[..], &[0; 2], &body.unwrap_or_default()].concat()
}

/// A message from CDR. Fails with what was found and what was expected.
pub(super) fn decoded<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let (head, body) =
        bytes.split_at_checked(4).ok_or_else(|| format!("found {} bytes; expected CDR", bytes.len()))?;
    let decoded = match [head[0], head[1]] {
        BIG => cdr_encoding::from_bytes::<T, BigEndian>(body),
        LITTLE => cdr_encoding::from_bytes::<T, LittleEndian>(body),
        other => {
            return Err(format!(
                "found data of the kind {other:02x?}; expected plain CDR, [00, 00] or [00, 01]"
            ));
        }
    };
    let wrong = |error| format!("found data that do not fit their type ({error}); expected CDR");
    decoded.map(|(message, _)| message).map_err(wrong)
}
