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
    /// The command that runs beside the page, as JSON: `command`.
    Beside = 9,
}
