//! Content of the page that shows a run: [`Message`]s, among them the [`Frames`] of its world. The page runs
//! commands by itself (member `web`), or is beside a run: the module `serve`, with the feature of that name,
//! serves it from a running program.

mod face;
mod frame;
mod message;
mod overlay;
#[cfg(feature = "serve")]
mod recorded;
mod scene;
#[cfg(feature = "serve")]
pub mod serve;

pub use face::{Face, Look};
pub use frame::{Displayed, Frames, IMAGE_INTERVAL, Shown};
pub use message::Message;
pub use overlay::overlay_json;
pub use scene::scene_json;
