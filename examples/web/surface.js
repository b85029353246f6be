// The texture on a mesh: which asset its materials carry, and where on the surface a point is (spec/materials-1.md).

import { Raycaster } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const EXTENSION = "HTEX_texture";
const MEDIA_TYPE = "application/vnd.htex+zip";
const MM_PER_M = 1e3;

/** Reads a `.glb` or `.gltf` file: its `scene`, the `material`'s extension, and `asset`, the bytes of the `.htex` file. */
export async function read(file) {
  const gltf = await new GLTFLoader().parseAsync(file, "");
  const found = new Map();
  gltf.scene.traverse(({ material }) => {
    for (const one of [material].flat()) {
      const extension = one?.userData.gltfExtensions?.[EXTENSION];
      if (extension) found.set(extension.bufferView, extension);
    }
  });
  if (found.size !== 1) throw new Error(`the materials of its meshes carry ${found.size} textures by ${EXTENSION}; one is played`);
  const [material] = found.values();
  if (material.mimeType !== MEDIA_TYPE) throw new Error(`${EXTENSION} has the mimeType ${material.mimeType}; ${MEDIA_TYPE} is played`);
  if ((material.texCoord ?? 0) > 1) throw new Error(`${EXTENSION} has the texCoord ${material.texCoord}; this page knows 0 and 1`);
  const asset = await gltf.parser.getDependency("bufferView", material.bufferView);
  return { scene: gltf.scene, material, asset };
}

/** The place on the texture that a ray meets first: `{ point, x, y }` in metres of the scene and mm of the surface; null beside it. Without
 * coordinates or their size `x` and `y` are undefined. */
export function touched(surface, pointer, camera) {
  const raycaster = new Raycaster();
  raycaster.setFromCamera(pointer, camera);
  const [hit] = raycaster.intersectObject(surface.scene, true);
  const material = [hit?.object.material].flat()[hit?.face?.materialIndex ?? 0];
  if (!material?.userData.gltfExtensions?.[EXTENSION]) return null;
  const { texCoord = 0, texCoordSizeMm: size } = surface.material;
  const uv = texCoord === 0 ? hit.uv : hit.uv1;
  const place = size && uv ? { x: uv.x * size[0], y: uv.y * size[1] } : {};
  return { point: hit.point.clone(), ...place };
}

/** Way over the surface between two places, mm. */
export function way(from, to) {
  if (from.x !== undefined && to.x !== undefined) return Math.hypot(to.x - from.x, to.y - from.y);
  return MM_PER_M * to.point.distanceTo(from.point);
}
