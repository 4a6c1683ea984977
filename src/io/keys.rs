use super::Result;

/// One of the four soft keys below the display.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Key {
    /// The leftmost.
    Key1,
    /// The second from the left.
    Key2,
    /// The third from the left.
    Key3,
    /// The rightmost.
    Key4,
}

impl Key {
    /// All keys from left to right.
    pub const ALL: [Key; 4] = [Key::Key1, Key::Key2, Key::Key3, Key::Key4];
}

/// The keys and the touch screen.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Keys {
    /// The oldest key press that has not been read, if any; does not wait.
    fn read_key(&mut self) -> Result<Option<Key>>;

    /// Waits for a key press.
    fn wait_key(&mut self) -> Result<Key>;

    /// The oldest touch of the display that has not been read, in pixels from the upper left corner; does not wait.
    fn read_touch(&mut self) -> Result<Option<(i32, i32)>>;
}
