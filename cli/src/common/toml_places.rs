use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Line and column of a byte of a text, as `LINE:COLUMN`.
pub(crate) fn of_byte(text: &str, byte: usize) -> String {
    let before = &text[..byte.min(text.len())];
    let line = before.matches('\n').count() + 1;
    let column = before.len() - before.rfind('\n').map_or(0, |end| end + 1) + 1;
    format!("{line}:{column}")
}

/// The same of the value at a path of keys and indices in a TOML text, or of the last part of the path that
/// is there.
pub(crate) fn of_value(text: &str, path: &[String]) -> String {
    let Ok(table) = DeTable::parse(text) else { return of_byte(text, 0) };
    let mut here: Option<&Spanned<DeValue<'_>>> = None;
    for part in path {
        let next = match (here, part.parse::<usize>()) {
            (None, _) => table.get_ref().get(part.as_str()),
            (Some(list), Ok(index)) => list.get_ref().get(index),
            (Some(table), Err(_)) => table.get_ref().get(part.as_str()),
        };
        let Some(next) = next else { break };
        here = Some(next);
    }
    of_byte(text, here.map_or(0, |value| value.span().start))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_found_by_their_path() {
        let text = "a = 1\n\n[body]\nlength = 2\n[[limb]]\n  on = 3\n[[limb]]\non = [4,\n 5]\n";
        for (path, place) in [
            ("a", "1:5"),
            ("body.length", "4:10"),
            ("limb.0.on", "6:8"),
            ("limb.1.on.1", "9:2"),
            ("limb.1.mass", "7:1"),
            ("none", "1:1"),
        ] {
            let path: Vec<String> = path.split('.').map(str::to_owned).collect();
            assert_eq!(of_value(text, &path), place, "{path:?}");
        }
    }
}
