// Materials as the scene gives them, with their textures. Each shape has its own, because a selected body is
// tinted alone.
import { Color, MeshStandardMaterial, RepeatWrapping, SRGBColorSpace, Texture } from "three";
import type { MaterialDescription, ShapeDescription, TextureData, WorldDescription } from "../link/messages";

export class Materials {
  private textures = new Map<number, Texture>();
  private list: MaterialDescription[] = [];

  // `leaveOut` gets the reason if a texture cannot be used.
  constructor(private readonly fetch: (texture: number) => Promise<TextureData>, private readonly leaveOut: (error: unknown) => void) {}

  async load(description: WorldDescription): Promise<void> {
    for (const texture of this.textures.values()) texture.dispose();
    this.textures = new Map();
    this.list = description.materials;
    const wanted = new Set(this.list.map((material) => material.texture).filter((texture) => texture > 0));
    const textures = this.textures;
    await Promise.all([...wanted].map(async (texture) => {
      try {
        textures.set(texture, await decode(await this.fetch(texture - 1)));
      } catch (error) {
        this.leaveOut(error);
      }
    }));
  }

  of(shape: ShapeDescription): MeshStandardMaterial {
    const [r = 0.7, g = 0.7, b = 0.7, a = 1] = shape.color;
    const description = shape.material > 0 ? this.list[shape.material - 1] : undefined;
    const material = new MeshStandardMaterial({
      color: new Color().setRGB(r, g, b, SRGBColorSpace),
      opacity: a > 0 ? a : 1, // invisible shapes show as collision shapes only
      transparent: a > 0 && a < 1,
      roughness: description?.roughness ?? 0.62,
      metalness: description?.metalness ?? 0.05,
    });
    const texture = description && this.textures.get(description.texture);
    if (texture) material.map = tiled(texture, shape, description.textureSize);
    return material;
  }
}

async function decode(data: TextureData): Promise<Texture> {
  const picture = await createImageBitmap(new Blob([new Uint8Array(data.data)], { type: data.contentType }), { imageOrientation: "flipY" });
  const texture = new Texture(picture);
  texture.flipY = false; // the picture is already turned
  texture.colorSpace = SRGBColorSpace;
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.anisotropy = 4;
  texture.needsUpdate = true;
  return texture;
}

// The number of tiles for one unit (0 to 1) of the shape's own texture coordinates.
function tiled(texture: Texture, shape: ShapeDescription, [tileX = 1, tileY = 1]: number[]): Texture {
  const own = texture.clone();
  const [x, y] = extent(shape);
  own.repeat.set(x / tileX, y / tileY);
  own.needsUpdate = true;
  return own;
}

const kPlaneLength = 60; // m, as in shapes.ts

function extent({ kind, size }: ShapeDescription): [number, number] {
  const [a = 1, b = 1] = size;
  if (kind === "plane") return [kPlaneLength, kPlaneLength];
  if (kind === "sphere") return [2 * Math.PI * a, Math.PI * a];
  return kind === "box" ? [a, b] : [2 * Math.PI * a, b];
}
