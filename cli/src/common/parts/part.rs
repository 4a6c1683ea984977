use std::fmt;
use std::str::FromStr;

/// A part of a campaign: every N-th run, from the K-th on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Part {
    /// From 1 on.
    pub(crate) number: u64,
    pub(crate) of: u64,
}

/// Largest number of parts.
const MOST: u64 = 100_000;

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parsed = text.split_once('/').and_then(|(number, of)| {
            let part = Self { number: number.trim().parse().ok()?, of: of.trim().parse().ok()? };
            (part.number >= 1 && part.number <= part.of && part.of <= MOST).then_some(part)
        });
        parsed.ok_or_else(|| format!("expected K/N, such as 2/4, with K from 1 to N and N up to {MOST}"))
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl Part {
    /// Number of its runs, of all those of a campaign.
    pub(crate) fn runs(self, all: u64) -> u64 {
        all / self.of + u64::from(all % self.of >= self.number)
    }

    /// Index in the campaign of one of its runs.
    pub(crate) fn run(self, index: u64) -> u64 {
        index * self.of + self.number - 1
    }
}
