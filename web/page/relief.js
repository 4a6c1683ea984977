// Hills, seen from above.

// A picture of hills in light from the upper left, with a pixel for each sample.
export function shaded({ area: [left, bottom, right, top], columns, heights }) {
  const rows = heights.length / columns, picture = new OffscreenCanvas(columns, rows), context = picture.getContext("2d");
  const pixels = context.createImageData(columns, rows), low = Math.min(...heights), range = Math.max(...heights) - low || 1;
  const [dx, dy] = [(right - left) / (columns - 1), (top - bottom) / (rows - 1)];
  const at = (column, row) => heights[Math.min(Math.max(row, 0), rows - 1) * columns + Math.min(Math.max(column, 0), columns - 1)] / 1000;
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const sx = (at(column + 1, row) - at(column - 1, row)) / (2 * dx), sy = (at(column, row + 1) - at(column, row - 1)) / (2 * dy);
      // The light comes from the upper left, 45 degrees high.
      const light = (0.5 * sx - 0.5 * sy + Math.SQRT1_2) / Math.hypot(sx, sy, 1) / Math.SQRT1_2;
      const share = (1000 * at(column, row) - low) / range, shade = 0.35 + 0.65 * Math.min(Math.max(light, 0), 1.25) / 1.25;
      const colour = [150, 168, 120].map((part, channel) => (part + share * ([236, 228, 210][channel] - part)) * shade);
      pixels.data.set([...colour, 255], 4 * ((rows - 1 - row) * columns + column));
    }
  }
  context.putImageData(pixels, 0, 0);
  return picture;
}
