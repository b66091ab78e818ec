// The blocks of the page as arrays; their form is told in block.rs.

const meta = JSON.parse(document.getElementById('meta').textContent);

/** The cells of one state: numbers of sites, positions in units of the page's size, and faces between cells. */
async function readBlock(index) {
  const state = meta.states[index];
  const text = document.getElementById(`block-${index}`).textContent;
  const inflated = new Blob([decoded(text)]).stream().pipeThrough(new DecompressionStream('deflate'));
  const buffer = await new Response(inflated).arrayBuffer();
  const n = state.cells;
  let at = 0;
  const take = (Kind, length) => {
    const array = new Kind(buffer, at, length);
    at += array.byteLength;
    return array;
  };
  const cells = {
    count: n, row: state.row, label: state.label,
    site: take(Uint32Array, n),
    position: take(Float32Array, 3 * n),
    barycenter: take(Float32Array, 3 * n),
    fields: meta.fields.map(() => take(Float32Array, n)),
    status: take(Uint8Array, n),
  };
  cells.points = points(take(Uint8Array, 9 * state.points), state.points);
  const streams = state.streams.map((length) => take(Uint8Array, length));
  return Object.assign(cells, faces(state, streams));
}

function decoded(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** Coordinates of 24 bits, whose bytes stand apart. */
function points(bytes, count) {
  const points = new Float32Array(3 * count);
  for (let k = 0; k < 3; k++) {
    const low = 3 * k * count, middle = low + count, high = middle + count;
    for (let i = 0; i < count; i++) {
      points[3 * i + k] = (bytes[low + i] | bytes[middle + i] << 8 | bytes[high + i] << 16) / 0xffffff;
    }
  }
  return points;
}

/**
 * Of each face the cell that it is counterclockwise from outside of, the cell beyond it (-1 for none), and its corners, from `start[f]` to before
 * `start[f + 1]`; an edge whose corner is `soft` is none between facets.
 */
function faces(state, streams) {
  const at = [0, 0, 0, 0];
  const next = (k) => {
    const stream = streams[k];
    let byte = stream[at[k]++];
    let number = byte & 0x7f;
    for (let shift = 7; byte >= 0x80; shift += 7) {
      byte = stream[at[k]++];
      number |= (byte & 0x7f) << shift;
    }
    return number >>> 0;
  };
  const inner = new Uint32Array(state.faces), outer = new Int32Array(state.faces), start = new Uint32Array(state.faces + 1);
  const corners = new Uint32Array(state.corners), soft = new Uint8Array(state.corners);
  let face = 0, corner = 0, known = 0;
  for (let cell = 0; cell < state.cells; cell++) {
    for (let left = next(0); left > 0; left--, face++) {
      const beyond = next(1);
      inner[face] = cell;
      outer[face] = beyond ? cell + beyond : -1;
      for (let more = next(2); more > 0; more--, corner++) {
        const code = next(3);
        soft[corner] = code & 1;
        const back = code >>> 1;
        corners[corner] = back ? known - back : known++;
      }
      start[face + 1] = corner;
    }
  }
  return { faces: state.faces, inner, outer, start, corners, soft };
}

/** The faces at each cell: those of cell c are `list[first[c]]` to before `list[first[c + 1]]`. */
function facesOfCells(cells) {
  if (cells.incident) return cells.incident;
  const first = new Uint32Array(cells.count + 1);
  const each = (visit) => {
    for (let f = 0; f < cells.faces; f++) {
      visit(cells.inner[f], f);
      if (cells.outer[f] >= 0) visit(cells.outer[f], f);
    }
  };
  each((cell) => first[cell + 1]++);
  for (let c = 0; c < cells.count; c++) first[c + 1] += first[c];
  const list = new Uint32Array(first[cells.count]);
  const place = first.slice();
  each((cell, f) => { list[place[cell]++] = f; });
  cells.incident = { first, list };
  return cells.incident;
}

/** The area of a face, in units of the size squared. */
function areaOf(cells, f) {
  const p = cells.points, from = cells.start[f], to = cells.start[f + 1];
  const at = (corner, k) => p[3 * cells.corners[corner] + k] - p[3 * cells.corners[from] + k];
  const sum = [0, 0, 0];
  for (let c = from + 1; c + 1 < to; c++) {
    for (let k = 0; k < 3; k++) {
      const i = (k + 1) % 3, j = (k + 2) % 3;
      sum[k] += at(c, i) * at(c + 1, j) - at(c, j) * at(c + 1, i);
    }
  }
  return Math.hypot(...sum) / 2;
}
