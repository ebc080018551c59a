// Names of three.js that src/fingertip/page/assets/viewer.js uses. All else is left out of the bundle.
export {
  AlwaysStencilFunc, BackSide, BufferAttribute, BufferGeometry, Color, DecrementWrapStencilOp, DirectionalLight,
  DoubleSide, FrontSide, Group, HemisphereLight, IncrementWrapStencilOp, KeepStencilOp, LineBasicMaterial,
  LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, NotEqualStencilFunc, OrthographicCamera, Plane,
  PlaneGeometry, REVISION, ReplaceStencilOp, Scene, Vector3, WebGLRenderer,
} from 'three';
export { OrbitControls } from 'three/addons/controls/OrbitControls.js';
