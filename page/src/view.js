// What is seen: one mesh, coloured by a texture with a pixel for each cell, so that colours and the distance between cells change without new triangles.

const TEXTURE_WIDTH = 1024;
/** So many triangles any device draws at once. Of more, which only cells that stand apart have, it is measured how long they take. */
const ALWAYS = 400000;
/** Milliseconds that a frame may take while the view turns, and when it rests: what does not go in is left out, the outer layers coming first. */
const MOVING = 60, RESTING = 1000;

const VERTEX = `
uniform highp sampler2D centers;
uniform highp sampler2D tints;
uniform float spread;
uniform vec3 middle;
in uint code;
out vec3 seen;
out vec3 at;
out float rim;
flat out vec4 tint;
flat out uint cell;
void main() {
  at = position;
  cell = code >> 1u;
  rim = float(code & 1u);
  ivec2 pixel = ivec2(int(cell) % ${TEXTURE_WIDTH}, int(cell) / ${TEXTURE_WIDTH});
  tint = texelFetch(tints, pixel, 0);
  vec3 center = texelFetch(centers, pixel, 0).xyz;
  // Apart and made smaller, so that all of it stays where it is seen.
  vec4 place = modelViewMatrix * vec4(middle + (position - middle + spread * (center - middle)) / (1.0 + spread), 1.0);
  seen = place.xyz;
  gl_Position = projectionMatrix * place;
}`;

const FRAGMENT = `
precision highp float;
uniform bool picks;
uniform vec3 line;
uniform float strength;
// Beyond it nothing is seen.
uniform vec4 plane;
uniform bool fills;
in vec3 seen;
in vec3 at;
in float rim;
flat in vec4 tint;
flat in uint cell;
out vec4 color;
void main() {
  // What lies in the plane is not beyond it, however it is rounded.
  bool inPlane = fills && rim > 0.5;
  if ((dot(plane.xyz, at) > plane.w && !inPlane) || (fills && gl_FrontFacing)) discard;
  if (picks) {
    uint number = cell + 1u;
    color = vec4(float(number & 255u), float(number >> 8u & 255u), float(number >> 16u & 255u), 255.0) / 255.0;
    return;
  }
  // The inside of a cell that the plane has opened: it is seen as the cut itself. Neighbours of one colour are told apart.
  if (fills || (plane.xyz != vec3(0.0) && !gl_FrontFacing)) {
    color = vec4(tint.rgb * (0.86 + 0.14 * float(cell * 2654435761u >> 24u) / 255.0), 1.0);
    return;
  }
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  vec3 toEye = normalize(-seen);
  float facing = abs(dot(normal, toEye));
  float above = abs(dot(normal, normalize(vec3(0.35, 0.8, 0.5))));
  vec3 lit = tint.rgb * (0.62 + 0.34 * facing + 0.2 * above);
  float width = fwidth(rim);
  float edge = smoothstep(1.0 - 1.6 * width, 1.0 - 0.4 * width, rim) * strength / (1.0 + 14.0 * width * width);
  color = vec4(mix(lit, line, edge), 1.0);
}`;

class View {
  constructor(canvas, context) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, context, alpha: true });
    // There is nothing to sort, and where the triangles are need not be known for it.
    this.renderer.sortObjects = false;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.scene = new THREE.Scene();
    this.extent = [0, 1, 2].map((k) => (meta.hi[k] - meta.lo[k]) / meta.size);
    const middle = new THREE.Vector3(...this.extent).multiplyScalar(0.5);
    this.radius = middle.length();
    this.camera = new THREE.PerspectiveCamera(32, 1, this.radius / 100, this.radius * 100);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.moved());
    const texture = (array, type) => {
      const made = new THREE.DataTexture(array, TEXTURE_WIDTH, 1, THREE.RGBAFormat, type);
      made.minFilter = made.magFilter = THREE.NearestFilter;
      return made;
    };
    this.uniforms = {
      centers: { value: texture(new Float32Array(4 * TEXTURE_WIDTH), THREE.FloatType) },
      tints: { value: texture(new Uint8Array(4 * TEXTURE_WIDTH), THREE.UnsignedByteType) },
      spread: { value: 0 }, middle: { value: middle }, picks: { value: false },
      line: { value: new THREE.Vector3(0.08, 0.1, 0.13) }, strength: { value: 0.7 },
      plane: { value: [0, 0, 0, 1] },
    };
    const mesh = (fills) => {
      const uniforms = { ...this.uniforms, fills: { value: fills } };
      const material = new THREE.ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, glslVersion: THREE.GLSL3, uniforms, side: THREE.DoubleSide });
      const made = new THREE.Mesh(new THREE.BufferGeometry(), material);
      made.frustumCulled = false;
      // Until there are triangles.
      made.visible = false;
      return made;
    };
    this.mesh = mesh(false);
    /** What fills a cut through cells: seen from behind. */
    this.filling = mesh(true);
    this.lines = this.outline();
    this.scene.add(this.mesh, this.filling, this.lines);
    this.vertices = 0;
    /** Triangles a millisecond. */
    this.rate = 0;
    this.picked = new THREE.WebGLRenderTarget(1, 1);
    this.resize();
    this.home();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }

  /** The edges of the box. */
  outline() {
    const corner = (c) => [0, 1, 2].map((k) => (c >> k & 1 ? this.extent[k] : 0));
    const ends = [];
    for (let c = 0; c < 8; c++) for (let k = 0; k < 3; k++) if (!(c >> k & 1)) ends.push(...corner(c), ...corner(c | 1 << k));
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(ends), 3));
    return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: 0x888f98, transparent: true, opacity: 0.5 }));
  }

  home() {
    const middle = this.uniforms.middle.value;
    this.controls.target.copy(middle);
    this.camera.up.set(0, 1, 0);
    const from = new THREE.Vector3(0.55, 0.42, 1).normalize();
    this.camera.position.copy(from).multiplyScalar(this.distance(from)).add(middle);
    this.controls.update();
    this.draw();
  }

  /** How far away in a direction all corners of the box are seen. */
  distance(from) {
    const across = new THREE.Vector3(0, 1, 0).cross(from).normalize(), up = from.clone().cross(across);
    const half = Math.tan(this.camera.fov * Math.PI / 360), corner = new THREE.Vector3();
    let distance = 0;
    for (let c = 0; c < 8; c++) {
      corner.set(...[0, 1, 2].map((k) => (c >> k & 1 ? 0.5 : -0.5) * this.extent[k]));
      const wide = Math.abs(corner.dot(across)) / this.camera.aspect, high = Math.abs(corner.dot(up));
      distance = Math.max(distance, corner.dot(from) + 1.06 * Math.max(wide, high) / half);
    }
    return distance;
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    if (!clientWidth || !clientHeight) return;
    const before = this.camera.aspect;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    if (before < 1 !== this.camera.aspect < 1) this.home();
    this.draw();
  }

  /** The state whose cells are shown from now on. */
  setCells(cells) {
    this.cells = cells;
    const height = Math.max(1, Math.ceil(cells.count / TEXTURE_WIDTH));
    const centers = new Float32Array(4 * TEXTURE_WIDTH * height);
    for (let c = 0; c < cells.count; c++) for (let k = 0; k < 3; k++) centers[4 * c + k] = cells.barycenter[3 * c + k];
    this.replace('centers', centers, height);
    this.replace('tints', new Uint8Array(4 * TEXTURE_WIDTH * height), height);
  }

  replace(name, data, height) {
    const texture = this.uniforms[name].value;
    texture.dispose();
    texture.image = { data, width: TEXTURE_WIDTH, height };
    texture.needsUpdate = true;
  }

  /** Colours: `paint(cell)` gives three numbers from 0 to 255. */
  setTints(paint) {
    const texture = this.uniforms.tints.value, data = texture.image.data;
    for (let c = 0; c < this.cells.count; c++) {
      const color = paint(c);
      data[4 * c] = color[0]; data[4 * c + 1] = color[1]; data[4 * c + 2] = color[2]; data[4 * c + 3] = 255;
    }
    texture.needsUpdate = true;
    this.draw();
  }

  /** Which cells are shown, and how far they are moved from the middle, as a share of where they are. */
  setShown(shown, spread) {
    this.setShapes(spread > 0 ? apart(this.cells, shown) : hull(this.cells, shown), null, [0, 0, 0, 1], spread);
  }

  /** Cells that a plane cuts through: beyond it the first three numbers of `through.plane` times the place are more than the fourth. */
  setThrough(through) {
    this.setShapes(borderOf(this.cells, through.shown), filling(this.cells, through), through.plane, 0);
  }

  setShapes(shape, filling, plane, spread) {
    this.vertices = this.setTriangles(this.mesh, shape);
    this.setTriangles(this.filling, filling);
    this.uniforms.plane.value = plane;
    this.uniforms.spread.value = spread;
    this.moved();
  }

  /** Gives a mesh its triangles; how many vertices they have. */
  setTriangles(mesh, shape) {
    const geometry = new THREE.BufferGeometry();
    if (shape) {
      geometry.setAttribute('position', new THREE.BufferAttribute(shape.position, 3));
      geometry.setAttribute('code', new THREE.BufferAttribute(shape.code, 1));
      if (shape.index) geometry.setIndex(new THREE.BufferAttribute(shape.index, 1));
    }
    mesh.geometry.dispose();
    mesh.geometry = geometry;
    mesh.visible = shape !== null && shape.code.length > 0;
    return shape === null ? 0 : (shape.index ?? shape.code).length;
  }

  setSpread(spread) {
    this.uniforms.spread.value = spread;
    this.moved();
  }

  /** Draws at once what is quick, and more when nothing has moved for a while. */
  moved() {
    this.isMoving = this.vertices > 3 * ALWAYS;
    clearTimeout(this.rest);
    if (this.isMoving) {
      this.rest = setTimeout(() => {
        this.isMoving = false;
        this.draw();
      }, 200);
    }
    this.draw();
  }

  draw() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    this.isDue = false;
    const all = this.vertices / 3;
    const drawn = Math.min(all, Math.max(ALWAYS, this.rate * (this.isMoving ? MOVING : RESTING)));
    this.mesh.geometry.setDrawRange(0, 3 * Math.floor(drawn));
    const start = performance.now();
    this.renderer.render(this.scene, this.camera);
    if (all > ALWAYS) {
      this.finish();
      this.rate = drawn / (performance.now() - start);
    }
    if (!this.isMoving && this.onShare) this.onShare(drawn / all);
    if (this.onDrawn) this.onDrawn();
  }

  /** Waits until what was drawn is there: only reading a pixel does. */
  finish() {
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  /** The cell at a point of the canvas, in pixels of the page; -1 where there is none. */
  pick(x, y) {
    const { clientWidth, clientHeight } = this.canvas;
    this.camera.setViewOffset(clientWidth, clientHeight, Math.floor(x), Math.floor(y), 1, 1);
    this.uniforms.picks.value = true;
    this.lines.visible = false;
    this.renderer.setRenderTarget(this.picked);
    this.renderer.setClearColor(0, 0);
    this.renderer.clear();
    this.renderer.render(this.scene, this.camera);
    const [a, b, c, opaque] = this.pixel();
    this.renderer.setRenderTarget(null);
    this.lines.visible = true;
    this.uniforms.picks.value = false;
    this.camera.clearViewOffset();
    return opaque ? (a | b << 8 | c << 16) - 1 : -1;
  }

  pixel() {
    const bytes = new Uint8Array(4);
    this.renderer.readRenderTargetPixels(this.picked, 0, 0, 1, 1, bytes);
    return bytes;
  }

  /** Turns the view by angles, as the pointer does. */
  turn(across, up) {
    const target = this.controls.target, offset = this.camera.position.clone().sub(target);
    const length = offset.length();
    const around = Math.atan2(offset.x, offset.z) + across;
    const down = Math.min(Math.PI - 0.01, Math.max(0.01, Math.acos(offset.y / length) - up));
    offset.set(Math.sin(down) * Math.sin(around), Math.cos(down), Math.sin(down) * Math.cos(around)).multiplyScalar(length);
    this.camera.position.copy(target).add(offset);
    this.controls.update();
  }

  zoom(factor) {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.moved();
  }
}
