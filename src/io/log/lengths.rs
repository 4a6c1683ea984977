use mcap::records::op;

/// A part of a record, as the specification of MCAP lists them.
enum Field {
    /// A number of bytes.
    Fixed(usize),
    /// Bytes behind their number, of 4 bytes.
    Text,
    /// Bytes behind their number, of 8 bytes.
    Data,
    /// Texts, behind the number of their bytes.
    Texts,
}

/// Whether the texts and data that a record holds end within it. Parsers take that for granted, or ask for as
/// much memory as a length says before they see that there is less to read.
pub(super) fn fit(opcode: u8, body: &[u8]) -> bool {
    use Field::{Data, Fixed, Text, Texts};
    let fields: &[Field] = match opcode {
        op::HEADER => &[Text, Text],
        op::SCHEMA => &[Fixed(2), Text, Text, Text],
        op::CHANNEL => &[Fixed(2 + 2), Text, Text, Texts],
        op::CHUNK => &[Fixed(3 * 8 + 4), Text, Data],
        op::CHUNK_INDEX => &[Fixed(4 * 8), Text, Fixed(8), Text, Fixed(2 * 8)],
        op::ATTACHMENT => &[Fixed(2 * 8), Text, Text, Data, Fixed(4)],
        op::ATTACHMENT_INDEX => &[Fixed(5 * 8), Text, Text],
        op::METADATA => &[Text, Texts],
        op::METADATA_INDEX => &[Fixed(2 * 8), Text],
        _ => &[],
    };
    let mut rest = body;
    fields.iter().all(|field| skip(field, &mut rest).is_some())
}

/// Goes on behind a field; `None` if it does not end before the bytes do.
fn skip(field: &Field, rest: &mut &[u8]) -> Option<()> {
    let mut take = |size: usize| {
        let (head, tail) = rest.split_at_checked(size)?;
        *rest = tail;
        Some(head)
    };
    let mut counted = |size: usize| {
        let length = take(size)?.iter().rev().fold(0, |length: u64, &byte| length << 8 | u64::from(byte));
        take(usize::try_from(length).ok()?)
    };
    match field {
        Field::Fixed(size) => take(*size).map(drop),
        Field::Text => counted(4).map(drop),
        Field::Data => counted(8).map(drop),
        Field::Texts => {
            let mut texts = counted(4)?;
            while !texts.is_empty() {
                skip(&Field::Text, &mut texts)?;
            }
            Some(())
        }
    }
}
