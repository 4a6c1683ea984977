use crate::vision::GrayView;

/// Minimum and maximum gray level around each pixel of an image.
#[derive(Debug, Clone, Default)]
pub(super) struct Ranges {
    width: usize,
    rows: Vec<(u8, u8)>,
    squares: Vec<(u8, u8)>,
}

impl Ranges {
    /// Computes the ranges over squares of half-width `reach`: first along the rows, then along the columns.
    pub(super) fn find(&mut self, image: GrayView<'_>, reach: usize) {
        let (width, height) = image.size();
        self.width = width;
        self.rows.clear();
        for y in 0..height {
            let row = image.row(y);
            self.rows.extend((0..width).map(|x| {
                let near =
                    &row[x.saturating_sub(reach)..x.saturating_add(reach).saturating_add(1).min(width)];
                near.iter().fold((u8::MAX, u8::MIN), |range, &shade| joined(range, (shade, shade)))
            }));
        }
        self.squares.clear();
        for y in 0..height {
            let near = y.saturating_sub(reach)..y.saturating_add(reach).saturating_add(1).min(height);
            let column = |x| near.clone().map(move |y| y * width + x);
            self.squares.extend(
                (0..width)
                    .map(|x| column(x).fold((u8::MAX, u8::MIN), |range, i| joined(range, self.rows[i]))),
            );
        }
    }

    /// Range at a pixel.
    pub(super) fn at(&self, x: usize, y: usize) -> (u8, u8) {
        self.squares[y * self.width + x]
    }

    /// Ranges of a row.
    pub(super) fn row(&self, y: usize) -> impl Iterator<Item = (u8, u8)> + '_ {
        self.squares[y * self.width..][..self.width].iter().copied()
    }
}

fn joined(a: (u8, u8), b: (u8, u8)) -> (u8, u8) {
    (a.0.min(b.0), a.1.max(b.1))
}
