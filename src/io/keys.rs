use super::Result;

/// One of the four soft keys below the display.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Key {
    /// Leftmost key.
    Key1,
    /// Second key from the left.
    Key2,
    /// Third key from the left.
    Key3,
    /// Rightmost key.
    Key4,
}

impl Key {
    /// All keys from left to right.
    pub const ALL: [Key; 4] = [Key::Key1, Key::Key2, Key::Key3, Key::Key4];
}

/// Soft keys and touch screen.
///
/// # For implementers
///
/// Keep presses and touches in order until they are read. Only `wait_key` may block.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Keys {
    /// The oldest unread key press, if any; does not block.
    fn read_key(&mut self) -> Result<Option<Key>>;

    /// Waits for a key press.
    fn wait_key(&mut self) -> Result<Key>;

    /// The oldest unread touch of the display, in pixels from the upper left corner; does not block.
    fn read_touch(&mut self) -> Result<Option<(i32, i32)>>;
}
