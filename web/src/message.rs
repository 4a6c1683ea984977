/// Kind of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Message {
    /// The scene before the robots start, as JSON.
    Scene = 1,
    /// A snapshot of the world; see the module `frame`.
    Frame = 2,
    /// A line of output: seconds as a `f64`, and the text.
    Told = 3,
    /// End of the run, as JSON: `status`, `output`, `errors`, `digest`.
    Ended = 4,
    /// The program has panicked, with the reason.
    Panicked = 5,
    /// Picture of the run, as SVG.
    Picture = 6,
    /// The commands and their options, as JSON.
    Options = 7,
    /// Additions of the run's picture besides the robots, as JSON.
    Overlay = 8,
}

/// A 64-bit FNV-1a digest (Fowler, Noll and Vo).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// Adds bytes.
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
