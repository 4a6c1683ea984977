//! Which lines of a text are those of a picture of a maze.
//!
//! Files are damaged: a line is lost, cut short or put in between. The lines of posts therefore vote on the width, and
//! what stands in the wrong place is a defect rather than the end of the picture.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use crate::maze::Defect;

/// The lines of a picture: posts and cells by turns, uppermost first.
pub(super) struct Layout<'a> {
    pub(super) lines: Vec<Line<'a>>,
    /// Cells from left to right.
    pub(super) width: usize,
    pub(super) post: u8,
    pub(super) defects: Vec<Defect>,
    /// How many lines of the text say something and are none of the picture.
    pub(super) remarks: usize,
}

/// A line of a picture.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    /// Its number in the file, from 1; where it is missing, that of the line in its place.
    pub(super) number: usize,
    /// What is left of it without the indentation; `None` where it is missing.
    pub(super) text: Option<&'a [u8]>,
}

/// What a line looks like.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Posts,
    Cells,
    Other,
}

/// Blanks to the left of a picture, its cells from left to right, and its posts.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Frame {
    indent: usize,
    width: usize,
    post: u8,
}

/// Whether a character is a post.
pub(super) fn is_post(byte: u8) -> bool {
    b"oO+*".contains(&byte)
}

/// Characters as messages show them.
pub(super) fn shown(bytes: &[u8]) -> String {
    format!("{:?}", String::from_utf8_lossy(bytes))
}

/// Looks for a picture.
pub(super) fn find<'a>(lines: &[&'a str]) -> Option<Layout<'a>> {
    let votes: Vec<Frame> = lines.iter().filter_map(|line| vote(line)).collect();
    let indent = most(votes.iter().map(|vote| vote.indent))?;
    let votes = votes.iter().filter(|vote| vote.indent == indent);
    let width = most(votes.clone().map(|vote| vote.width))?;
    let frame = *votes.clone().find(|vote| vote.width == width)?;
    let lines = lines.iter().map(|line| frame.cut(line)).collect();
    let mut finder = Finder { lines, frame, next: 0, found: Vec::new(), defects: Vec::new() };
    finder.next = finder.top();
    let top = finder.next;
    finder.follow();
    finder.note_others(top);
    let said = finder.lines.iter().enumerate().filter(|(_, line)| !is_blank(line));
    let remarks = said.filter(|(index, _)| !(top..finder.next).contains(index)).count();
    Some(Layout { lines: finder.found, width, post: frame.post, defects: finder.defects, remarks })
}

/// The picture that a line of posts belongs to: posts four columns apart, and the walls between them.
fn vote(line: &str) -> Option<Frame> {
    let indent = line.len() - line.trim_start().len();
    let bytes = line.trim().as_bytes();
    let post = *bytes.first().filter(|&&byte| is_post(byte))?;
    let posts = bytes.iter().step_by(4).take_while(|&&byte| byte == post).count();
    // A post may be missing from a line of the right length.
    let whole = bytes.len() % 4 == 1 && 2 * posts > bytes.len() / 4;
    let width = if whole { bytes.len() / 4 } else { posts - 1 };
    let drawn = bytes.get(1..4).is_some_and(|wall| wall.iter().all(|byte| b"-_= .".contains(byte)));
    (width > 0 && drawn).then_some(Frame { indent, width, post })
}

/// The value that comes most often, the first of those.
fn most(values: impl Iterator<Item = usize>) -> Option<usize> {
    let mut tallies = BTreeMap::new();
    for (index, value) in values.enumerate() {
        tallies.entry(value).or_insert((0_usize, Reverse(index))).0 += 1;
    }
    tallies.into_iter().max_by_key(|&(_, tally)| tally).map(|(value, _)| value)
}

fn is_blank(line: &[u8]) -> bool {
    line.trim_ascii().is_empty()
}

impl Frame {
    /// A line without the indentation.
    fn cut<'a>(&self, line: &&'a str) -> &'a [u8] {
        let blanks = line.bytes().take(self.indent).take_while(u8::is_ascii_whitespace).count();
        &line.as_bytes()[blanks..]
    }

    /// How many characters a whole line has.
    fn length(&self) -> usize {
        4 * self.width + 1
    }

    fn kind(&self, line: &[u8]) -> Kind {
        let line = &line[..line.len().min(self.length())];
        if self.has_posts(line) {
            Kind::Posts
        } else if self.has_cells(line) {
            Kind::Cells
        } else {
            Kind::Other
        }
    }

    /// Whether most of a line's posts are there, and hardly anything else but walls.
    fn has_posts(&self, line: &[u8]) -> bool {
        let posts = line.iter().step_by(4).filter(|&&byte| is_post(byte)).count();
        let odd = |&&byte: &&u8| !is_post(byte) && !b"-_= .|".contains(&byte);
        2 * posts > self.width && line.iter().filter(odd).count() <= (self.width / 4).max(1)
    }

    /// Whether a line has walls beside cells, and hardly anything else in their places.
    fn has_cells(&self, line: &[u8]) -> bool {
        let sides = line.iter().step_by(4);
        let good = sides.clone().filter(|byte| b"|. \t".contains(byte)).count();
        let bars = sides.clone().any(|&byte| byte == b'|');
        let plain = line.len() == self.length() && line.iter().all(|byte| b" .|SGsg\t".contains(byte));
        !is_blank(line) && 4 * good >= 3 * sides.count() && (bars || plain)
    }

    /// Whether a line that is none of posts was meant to be one.
    fn was_posts(line: &[u8]) -> bool {
        !is_blank(line) && line.trim_ascii().iter().all(|&byte| is_post(byte) || b"-_= .|".contains(&byte))
    }

    /// Whether there is a wall between all posts of a line.
    fn is_closed(&self, line: &[u8]) -> bool {
        let wall = |x: usize| line.get(4 * x + 1..4 * x + 4).is_some_and(|wall| !wall.contains(&b' '));
        (0..self.width).all(wall)
    }
}

/// Goes through a text from the first line of a picture to its last.
struct Finder<'a> {
    /// The text without the indentation of the picture.
    lines: Vec<&'a [u8]>,
    frame: Frame,
    /// The index of the next line to look at.
    next: usize,
    found: Vec<Line<'a>>,
    defects: Vec<Defect>,
}

impl Finder<'_> {
    fn kind(&self, index: usize) -> Option<Kind> {
        self.lines.get(index).map(|line| self.frame.kind(line))
    }

    /// The first line of the picture, which damage may have made unlike one of posts.
    fn top(&self) -> usize {
        let posts = |line: &&[u8]| {
            vote(&String::from_utf8_lossy(line)).is_some_and(|vote| vote.width == self.frame.width)
        };
        let mut top = self.lines.iter().position(posts).unwrap_or(0);
        loop {
            let above = |lines: usize| top.checked_sub(lines).and_then(|index| self.kind(index));
            match (above(1), above(2)) {
                (Some(Kind::Cells), Some(Kind::Posts)) => top -= 2,
                (Some(Kind::Cells), Some(Kind::Other)) if Frame::was_posts(self.lines[top - 2]) => {
                    return top - 2;
                }
                (Some(Kind::Cells), _) => return top - 1,
                (Some(Kind::Posts), _) => top -= 1,
                _ => return top,
            }
        }
    }

    /// Takes lines of posts and of cells by turns until neither follows.
    fn follow(&mut self) {
        loop {
            let wanted = if self.found.len().is_multiple_of(2) { Kind::Posts } else { Kind::Cells };
            let here = self.kind(self.next);
            let then = self.kind(self.next + 1);
            if here == Some(wanted) {
                self.take();
            } else if then == Some(wanted) && self.is_top_again() {
                self.skip(wanted);
            } else if wanted == Kind::Cells && self.another_begins() {
                return;
            } else if here.is_some_and(|kind| kind != Kind::Other) {
                self.miss(wanted);
            } else if here.is_some() && then == Some(wanted) {
                self.skip(wanted);
            } else if here.is_some() && (then.is_some_and(|kind| kind != Kind::Other) || self.is_end(wanted))
            {
                self.repair(wanted);
            } else {
                if wanted == Kind::Posts {
                    self.miss(wanted);
                }
                return;
            }
        }
    }

    /// Whether the next line is the top one once more.
    fn is_top_again(&self) -> bool {
        self.found.len() == 1 && self.found[0].text == Some(self.lines[self.next])
    }

    /// Whether another picture begins below this one: both are closed there.
    fn another_begins(&self) -> bool {
        let closed = |line: &[u8]| self.frame.is_closed(line);
        let last = self.found.last().and_then(|line| line.text).is_some_and(closed);
        let row = |line: &&[u8]| is_blank(line) && line.len() >= self.frame.length();
        let below = match self.kind(self.next) {
            Some(Kind::Other) if !row(&self.lines[self.next]) => self.next + 1,
            _ => self.next,
        };
        last && self.kind(below) == Some(Kind::Posts) && closed(self.lines[below])
    }

    /// Whether the next line is what is left of the lowest one.
    fn is_end(&self, wanted: Kind) -> bool {
        wanted == Kind::Posts && Frame::was_posts(self.lines[self.next])
    }

    fn take(&mut self) {
        self.found.push(Line { number: self.next + 1, text: Some(self.lines[self.next]) });
        self.next += 1;
    }

    /// Says what the next line is, and what it should be.
    fn note(&mut self, wanted: Kind, made: &str) {
        let found = match self.lines.get(self.next) {
            None => "the end of the file".into(),
            Some(line) if is_blank(line) => "a blank line".into(),
            Some(line) => shown(&line[..line.len().min(40)]),
        };
        let expected = if wanted == Kind::Posts { "posts" } else { "cells" };
        let message = format!("found {found}; expected a line of {expected}; {made}");
        self.defects.push(Defect::at(self.next + 1, message));
    }

    /// Makes up for a line that is not there.
    fn miss(&mut self, wanted: Kind) {
        self.note(wanted, "its walls are unknown");
        self.found.push(Line { number: self.next + 1, text: None });
    }

    /// Leaves out a line that was put in between.
    fn skip(&mut self, wanted: Kind) {
        self.note(wanted, "skipped");
        self.next += 1;
    }

    /// Takes a damaged line for what should stand in its place.
    fn repair(&mut self, wanted: Kind) {
        let line = self.lines[self.next];
        if !is_blank(line) {
            self.note(wanted, "read as one");
            self.take();
        } else if wanted == Kind::Cells && line.len() >= self.frame.length() {
            self.take();
        } else {
            self.miss(wanted);
            self.next += 1;
        }
    }

    /// Names the first line outside of the picture that seems to be one of a picture.
    fn note_others(&mut self, top: usize) {
        let drawn = |line: &[u8]| vote(&String::from_utf8_lossy(line)).is_some();
        let above = self.lines[..top].iter().position(|line| drawn(line));
        let below = || (self.next..self.lines.len()).find(|&index| self.kind(index) != Some(Kind::Other));
        if let Some(index) = above.or_else(below) {
            let message = format!(
                "found {} outside of the picture; expected remarks; ignored",
                shown(self.lines[index])
            );
            self.defects.push(Defect::at(index + 1, message));
        }
    }
}
