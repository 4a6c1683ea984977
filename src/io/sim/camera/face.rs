use super::canvas::{Canvas, Packed, Slope, Span};
use super::view::{NEAR, Place, Seen, View};

/// Buffers for clipping and drawing flat faces.
#[derive(Debug, Default)]
pub(super) struct Cutter {
    seen: Vec<Seen>,
    clipped: Vec<Seen>,
    corners: Vec<(f64, f64)>,
    spans: Vec<Span>,
}

/// A face's plane in the camera's frame: `normal . place = offset`. From the front, the offset is negative.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    pub(super) normal: Seen,
    pub(super) offset: f64,
}

impl Plane {
    /// Inverse depth over the picture.
    pub(super) fn nearness(&self, view: &View) -> Slope {
        let Seen { x, y, z } = self.normal;
        let scale = 1.0 / self.offset;
        let (column, row) = (x * scale / view.focal, y * scale / view.focal);
        let origin = (x * view.ray_x(0.0) + y * view.ray_y(0.0) + z) * scale;
        Slope { origin, column, row }
    }
}

impl Cutter {
    /// Draws a convex face in one colour. Its corners run counter-clockwise as seen from the front; the back
    /// is invisible.
    pub(super) fn draw(&mut self, canvas: &mut Canvas, view: &View, corners: &[Place], colour: Packed) {
        let Some(plane) = self.look(view, corners) else { return };
        if plane.offset >= 0.0 {
            return;
        }
        if let Some((top, spans)) = self.cut(view) {
            canvas.fill(top, spans, &plane.nearness(view), colour);
        }
    }

    /// Like [`draw`](Self::draw), with the back visible.
    pub(super) fn draw_either_side(
        &mut self,
        canvas: &mut Canvas,
        view: &View,
        corners: &[Place],
        colour: Packed,
    ) {
        if let Some(plane) = self.look(view, corners)
            && let Some((top, spans)) = self.cut(view)
        {
            canvas.fill(top, spans, &plane.nearness(view), colour);
        }
    }

    /// Draws how near a triangle is whose corners are in the camera's frame, where it is nearer than what is
    /// there. Its colour is none yet.
    pub(super) fn draw_seen(&mut self, canvas: &mut Canvas, view: &View, corners: &[Seen; 3]) {
        self.seen.clear();
        self.seen.extend_from_slice(corners);
        if let Some(plane) = self.plane()
            && let Some((top, spans)) = self.cut(view)
        {
            canvas.fill(top, spans, &plane.nearness(view), 0);
        }
    }

    /// Draws a convex face of the floor over the picture.
    pub(super) fn tint(
        &mut self,
        canvas: &mut Canvas,
        view: &View,
        corners: &[Place],
        colour: Packed,
        alpha: u8,
    ) {
        if self.look(view, corners).is_some_and(|plane| plane.offset < 0.0)
            && let Some((top, spans)) = self.cut(view)
        {
            canvas.tint(top, spans, colour, alpha);
        }
    }

    /// Like [`tint`](Self::tint), but only where the face is nearest.
    pub(super) fn tint_seen(
        &mut self,
        canvas: &mut Canvas,
        view: &View,
        corners: &[Place],
        colour: Packed,
        alpha: u8,
    ) {
        let Some(plane) = self.look(view, corners).filter(|plane| plane.offset < 0.0) else { return };
        if let Some((top, spans)) = self.cut(view) {
            canvas.tint_seen(top, spans, &plane.nearness(view), (colour, alpha));
        }
    }

    /// Takes a face's corners into the camera's frame. Returns its plane, if it has one that does not hold
    /// the eye.
    pub(super) fn look(&mut self, view: &View, corners: &[Place]) -> Option<Plane> {
        self.seen.clear();
        self.seen.extend(corners.iter().map(|&corner| view.see(corner)));
        self.plane()
    }

    /// The plane of the face that is looked at, if it has one that does not hold the eye.
    fn plane(&self) -> Option<Plane> {
        let first = *self.seen.first()?;
        // Twice the area as a vector; accurate even for faces with many close corners.
        let mut normal = Seen { x: 0.0, y: 0.0, z: 0.0 };
        for pair in self.seen.windows(2) {
            let part = pair[0].minus(first).cross(pair[1].minus(first));
            normal = Seen { x: normal.x + part.x, y: normal.y + part.y, z: normal.z + part.z };
        }
        let offset = normal.dot(first);
        (offset.abs() > 1e-9 * normal.norm()).then_some(Plane { normal, offset })
    }

    /// Rows and columns of the last transformed face: the first row, and a span for each row.
    pub(super) fn cut(&mut self, view: &View) -> Option<(usize, &[Span])> {
        self.clip();
        self.corners.clear();
        self.corners.extend(self.clipped.iter().map(|&seen| view.project(seen)));
        let rows = |edge: f64| super::canvas::first_pixel(edge, view.height);
        let (top, bottom) = self
            .corners
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(top, bottom), c| (top.min(c.1), bottom.max(c.1)));
        let (top, bottom) = (rows(top), rows(bottom));
        if top >= bottom {
            return None;
        }
        self.spans.clear();
        self.spans.resize(bottom - top, Span::EMPTY);
        for (i, &a) in self.corners.iter().enumerate() {
            let b = self.corners[(i + 1) % self.corners.len()];
            // Adjacent faces get identical pixels for their common edge.
            let (upper, lower) = if a.1 < b.1 { (a, b) } else { (b, a) };
            let slope = (lower.0 - upper.0) / (lower.1 - upper.1);
            for row in rows(upper.1)..rows(lower.1) {
                let x = upper.0 + (row as f64 + 0.5 - upper.1) * slope;
                let span = &mut self.spans[row - top];
                span.left = span.left.min(x);
                span.right = span.right.max(x);
            }
        }
        Some((top, &self.spans))
    }

    /// Clips the face at the near plane.
    fn clip(&mut self) {
        self.clipped.clear();
        for (i, &a) in self.seen.iter().enumerate() {
            let b = self.seen[(i + 1) % self.seen.len()];
            if a.z >= NEAR {
                self.clipped.push(a);
            }
            if (a.z >= NEAR) != (b.z >= NEAR) {
                let t = (NEAR - a.z) / (b.z - a.z);
                self.clipped.push(Seen { x: a.x + t * (b.x - a.x), y: a.y + t * (b.y - a.y), z: NEAR });
            }
        }
    }
}
