/// What a message carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Message {
    /// The scene in which robots are about to drive, as JSON.
    Scene = 1,
    /// The world at an instant; see the module `frame`.
    Frame = 2,
    /// A line that a person is told: seconds as a `f64`, and the text.
    Told = 3,
    /// How the run ended, as JSON: `status`, `output`, `errors`, `digest`.
    Ended = 4,
    /// The program has panicked: why.
    Panicked = 5,
    /// The picture of the run, as SVG.
    Picture = 6,
    /// The commands and their options, as JSON.
    Options = 7,
    /// What the picture of the run shows beside the robots, as JSON.
    Overlay = 8,
}

/// Sixty-four bits that tell streams of bytes apart, by Fowler, Noll and Vo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// Takes in some bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

impl std::fmt::Display for Digest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}
