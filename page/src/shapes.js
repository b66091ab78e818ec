// Triangles for the graphics card: of the faces that can be seen, or of all where cells stand apart.

/** Cells that stand apart with drawn edges, at most: beyond it a cell takes a quarter of the memory, without them. */
const MOST_WITH_EDGES = 20000;

/** What borders on what is not shown: a face between a cell of which `shown` is 1 and one of which it is 0, or nothing. */
function hull(cells, shown) {
  const { inner, outer, start } = cells;
  const isOfInner = (f) => shown[inner[f]] && (outer[f] < 0 || !shown[outer[f]]), isOfOuter = (f) => outer[f] >= 0 && shown[outer[f]] && !shown[inner[f]];
  let corners = 0;
  for (let f = 0; f < cells.faces; f++) if (isOfInner(f) || isOfOuter(f)) corners += start[f + 1] - start[f];
  const fans = new Fans(cells, corners);
  for (let f = 0; f < cells.faces; f++) {
    if (isOfInner(f)) fans.add(f, false);
    else if (isOfOuter(f)) fans.add(f, true);
  }
  return fans.shape();
}

/** The same where a plane cuts the cells that are shown: what is between them and others is beyond it, so that the border of all is left. */
function borderOf(cells, shown) {
  const { inner, outer, start } = cells;
  cells.border ??= Uint32Array.from(outer.keys()).filter((f) => outer[f] < 0);
  let corners = 0;
  for (const f of cells.border) if (shown[inner[f]]) corners += start[f + 1] - start[f];
  const fans = new Fans(cells, corners);
  for (const f of cells.border) if (shown[inner[f]]) fans.add(f, false);
  return fans.shape();
}

/**
 * What fills the cut of a plane through cells, seen from beyond it from behind: of a cell that is whole, and so convex, its section, some four triangles; of
 * one on the border, whose section may be anything, its inner faces, for where the plane opens it the backs of these are seen. (Faces for all were seven
 * times the triangles, and two thirds of a frame's time and more where a processor draws 100,000 cells.)
 */
function filling(cells, through) {
  const { start, outer, inner } = cells, { shown, isCut } = through, { first, list } = facesOfCells(cells);
  let corners = 0;
  for (let c = 0; c < cells.count; c++) if (isCut[c]) for (let k = first[c]; k < first[c + 1]; k++) corners += start[list[k] + 1] - start[list[k]];
  const fans = new Fans(cells, corners);
  for (let c = 0; c < cells.count; c++) {
    if (!isCut[c]) continue;
    const faces = list.subarray(first[c], first[c + 1]);
    if (faces.every((f) => outer[f] >= 0)) {
      section(fans, c, faces, through);
    } else {
      for (const f of faces) if (outer[f] >= 0 && shown[inner[f]] && shown[outer[f]]) fans.add(f, inner[f] !== c, false);
    }
  }
  return fans.shape();
}

/** The section of a convex cell: triangles from an end of its first side to the others, which need no order. */
function section(fans, c, faces, { axis, sign, at }) {
  const { points, corners, start, inner } = fans.cells;
  const beyond = (corner) => sign * points[3 * corners[corner] + axis] > sign * at;
  // Where an edge meets the plane: the same to the last bit for all faces at it.
  const meet = (one, other) => {
    const p = 3 * Math.min(corners[one], corners[other]), q = 3 * Math.max(corners[one], corners[other]);
    const share = (at - points[p + axis]) / (points[q + axis] - points[p + axis]);
    return [0, 1, 2].map((k) => (k === axis ? at : points[p + k] + share * (points[q + k] - points[p + k])));
  };
  let top = null;
  for (const f of faces) {
    let leaves = null, returns = null;
    for (let corner = start[f]; corner < start[f + 1]; corner++) {
      const next = corner + 1 < start[f + 1] ? corner + 1 : start[f];
      if (beyond(corner) === beyond(next)) continue;
      if (beyond(next)) leaves = meet(corner, next);
      else returns = meet(corner, next);
    }
    if (!leaves) continue;
    const [from, to] = inner[f] === c ? [leaves, returns] : [returns, leaves];
    if (top) fans.addTriangle(top, from, to, 2 * c + 1);
    top ??= from;
  }
}

/** Where each cell begins and ends along an axis; kept, as a slider asks again and again. */
function spans(cells, axis) {
  cells.spans ??= [];
  if (cells.spans[axis]) return cells.spans[axis];
  const { points, inner, outer, start, corners } = cells;
  const lo = new Float32Array(cells.count).fill(Infinity), hi = new Float32Array(cells.count).fill(-Infinity);
  for (let f = 0; f < cells.faces; f++) {
    for (let c = start[f]; c < start[f + 1]; c++) {
      const x = points[3 * corners[c] + axis];
      for (const cell of outer[f] < 0 ? [inner[f]] : [inner[f], outer[f]]) {
        if (x < lo[cell]) lo[cell] = x;
        if (x > hi[cell]) hi[cell] = x;
      }
    }
  }
  return cells.spans[axis] = { lo, hi };
}

/** All faces of the cells that are shown, those nearest to what is seen first. */
function apart(cells, shown) {
  const order = layers(cells, shown);
  return order.length <= MOST_WITH_EDGES ? apartWithEdges(cells, order) : apartWithout(cells, order);
}

function apartWithEdges(cells, order) {
  const { inner, start } = cells, { first, list } = facesOfCells(cells);
  let corners = 0;
  for (const c of order) for (let k = first[c]; k < first[c + 1]; k++) corners += start[list[k] + 1] - start[list[k]];
  const fans = new Fans(cells, corners);
  for (const c of order) for (let k = first[c]; k < first[c + 1]; k++) fans.add(list[k], inner[list[k]] !== c);
  return fans.shape();
}

/** The cells that are shown, layer by layer from what is seen. */
function layers(cells, shown) {
  const { inner, outer } = cells, { first, list } = facesOfCells(cells);
  const taken = new Uint8Array(cells.count), order = new Uint32Array(cells.count);
  let count = 0;
  const take = (c) => {
    if (c >= 0 && shown[c] && !taken[c]) {
      taken[c] = 1;
      order[count++] = c;
    }
  };
  for (let f = 0; f < cells.faces; f++) {
    if (outer[f] < 0 || !shown[inner[f]] || !shown[outer[f]]) {
      take(inner[f]);
      take(outer[f]);
    }
  }
  for (let done = 0; done < count; done++) {
    const c = order[done];
    for (let k = first[c]; k < first[c + 1]; k++) take(inner[list[k]] === c ? outer[list[k]] : inner[list[k]]);
  }
  return order.subarray(0, count);
}

/** Triangles from the middle of each face to its edges. A code is twice the cell, and 1 more at the ends of an edge that is drawn, or in the plane of a cut. */
class Fans {
  constructor(cells, corners) {
    this.cells = cells;
    this.position = new Float32Array(9 * corners);
    this.code = new Uint32Array(3 * corners);
    this.at = 0;
  }

  add(f, isTurned, hasEdges = true) {
    const { points, start, corners, soft, inner, outer } = this.cells;
    const from = start[f], to = start[f + 1], code = 2 * (isTurned ? outer[f] : inner[f]);
    let x = 0, y = 0, z = 0;
    for (let c = from; c < to; c++) {
      const p = 3 * corners[c];
      x += points[p]; y += points[p + 1]; z += points[p + 2];
    }
    x /= to - from; y /= to - from; z /= to - from;
    const position = this.position;
    for (let c = from; c < to; c++) {
      const a = 3 * corners[c], b = 3 * corners[c + 1 < to ? c + 1 : from], at = 3 * this.at;
      position[at] = x; position[at + 1] = y; position[at + 2] = z;
      const one = isTurned ? at + 6 : at + 3, other = isTurned ? at + 3 : at + 6;
      for (let k = 0; k < 3; k++) {
        position[one + k] = points[a + k];
        position[other + k] = points[b + k];
      }
      this.code[this.at] = code;
      this.code[this.at + 1] = this.code[this.at + 2] = hasEdges ? code + 1 - soft[c] : code;
      this.at += 3;
    }
  }

  addTriangle(a, b, c, code) {
    for (const corner of [a, b, c]) {
      this.position.set(corner, 3 * this.at);
      this.code[this.at++] = code;
    }
  }

  /** Of room that was not needed nothing is left. */
  shape() {
    return { position: this.position.slice(0, 3 * this.at), code: this.code.slice(0, this.at), index: null };
  }
}

/** Triangles from one corner of each face to the others; a cell has each of its corners once. */
function apartWithout(cells, order) {
  const { points, corners, start, inner } = cells, { first, list } = facesOfCells(cells);
  let most = 0, triangles = 0;
  for (const c of order) {
    for (let k = first[c]; k < first[c + 1]; k++) {
      const length = start[list[k] + 1] - start[list[k]];
      most += length;
      triangles += length - 2;
    }
  }
  const last = new Int32Array(points.length / 3).fill(-1), number = new Uint32Array(points.length / 3);
  // Each corner of a simple cell is in three faces; where more meet, in more.
  const position = new Float32Array(3 * most), code = new Uint32Array(most), index = new Uint32Array(3 * triangles);
  let vertices = 0, at = 0;
  for (const c of order) {
    const of = (corner) => {
      const p = corners[corner];
      if (last[p] !== c) {
        last[p] = c;
        number[p] = vertices;
        position.set(points.subarray(3 * p, 3 * p + 3), 3 * vertices);
        code[vertices++] = 2 * c;
      }
      return number[p];
    };
    for (let k = first[c]; k < first[c + 1]; k++) {
      const f = list[k], isTurned = inner[f] !== c, top = of(start[f]);
      let one = of(start[f] + 1);
      for (let corner = start[f] + 2; corner < start[f + 1]; corner++) {
        const other = of(corner);
        index[at++] = top;
        index[at++] = isTurned ? other : one;
        index[at++] = isTurned ? one : other;
        one = other;
      }
    }
  }
  return { position: position.slice(0, 3 * vertices), code: code.slice(0, vertices), index };
}
