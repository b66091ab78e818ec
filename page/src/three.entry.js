// What of three.js (https://threejs.org, MIT, its text in three-LICENSE) the page needs. `three.min.js` is made of this, in an empty folder, by
//   npm install --save-exact three@0.187.0 esbuild@0.28.2
//   npx esbuild three.entry.js --bundle --minify --format=iife --global-name=THREE --legal-comments=eof --outfile=three.min.js
export {
  BufferAttribute, BufferGeometry, DataTexture, DoubleSide, FloatType, GLSL3, LineBasicMaterial, LineSegments, Mesh, NearestFilter,
  PerspectiveCamera, RGBAFormat, Scene, ShaderMaterial, UnsignedByteType, Vector3, WebGLRenderTarget, WebGLRenderer, REVISION,
} from 'three';
export { OrbitControls } from 'three/addons/controls/OrbitControls.js';
