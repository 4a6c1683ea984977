//! Every parameter field of the crate is given nonsense: a constructor refuses it by the field's name, or the
//! table says that it is accepted; then what was made with it runs, and comes to an end.

mod check;
mod drive;
mod maze_and_nav;
mod race;
mod rest;
