#include "server/scene/collada/import.h"

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstdio>
#include <stdexcept>

namespace visum::collada {
namespace {

constexpr unsigned kCorners = 3;
constexpr std::size_t kHeaderBytes = 80;

constexpr int kNotRead = aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                         aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                         aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS;
// The graph is flattened: the triangles of each material, in the document's own frame.
constexpr unsigned kSteps = aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_RemoveComponent |
                            aiProcess_PreTransformVertices | aiProcess_ValidateDataStructure;

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, ' ');
  return text;
}

bool is_textured(const aiMaterial& material) {
  return material.GetTextureCount(aiTextureType_DIFFUSE) > 0;
}

std::optional<std::array<float, 4>> color_of(const aiMaterial& material) {
  aiColor4D color;
  if (is_textured(material)) return std::nullopt;  // assimp would say white
  if (material.Get(AI_MATKEY_COLOR_DIFFUSE, color) != AI_SUCCESS) return std::nullopt;
  // Alpha is ignored: exporters disagree on the meaning of Collada's transparency, and an invisible visual
  // helps nobody.
  const auto bounded = [](float x) { return std::clamp(x, 0.0f, 1.0f); };
  return std::array{bounded(color.r), bounded(color.g), bounded(color.b), 1.0f};
}

void add_triangles(const aiMesh& mesh, Part& part) {
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != kCorners) continue;
    std::array<float, 9> triangle{};
    for (unsigned corner = 0; corner < kCorners; ++corner) {
      const aiVector3D& at = mesh.mVertices[face.mIndices[corner]];
      std::copy_n(&at.x, 3, triangle.begin() + 3 * corner);
    }
    part.triangles.push_back(triangle);
  }
}

void append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}

std::string to_stl(const Part& part) {
  std::string bytes(kHeaderBytes, ' ');
  const auto count = static_cast<std::uint32_t>(part.triangles.size());
  append(bytes, &count, sizeof count);
  constexpr std::array<float, 3> kNoNormal{};
  constexpr std::uint16_t kNoAttribute = 0;
  for (const auto& triangle : part.triangles) {
    append(bytes, kNoNormal.data(), sizeof kNoNormal);
    append(bytes, triangle.data(), sizeof triangle);
    append(bytes, &kNoAttribute, sizeof kNoAttribute);
  }
  return bytes;
}

std::string color_text(const std::optional<std::array<float, 4>>& color) {
  if (!color) return "none";
  const auto& [r, g, b, a] = *color;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.6f %.6f %.6f %.6f", static_cast<double>(r),
                static_cast<double>(g), static_cast<double>(b), static_cast<double>(a));
  return text.data();
}

}  // namespace

Import import_collada(std::string_view document) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, kNotRead);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFileFromMemory(document.data(), document.size(), kSteps, "dae");
  if (scene == nullptr) throw std::runtime_error(one_line(importer.GetErrorString()));
  Import import;
  import.parts.resize(scene->mNumMaterials);
  for (unsigned i = 0; i < scene->mNumMaterials; ++i) {
    import.parts[i].color = color_of(*scene->mMaterials[i]);
    if (is_textured(*scene->mMaterials[i])) import.textured = true;
  }
  for (unsigned i = 0; i < scene->mNumMeshes; ++i)
    add_triangles(*scene->mMeshes[i], import.parts.at(scene->mMeshes[i]->mMaterialIndex));
  std::erase_if(import.parts, [](const Part& part) { return part.triangles.empty(); });
  if (import.parts.empty()) throw std::runtime_error("it holds no triangle");
  return import;
}

std::string to_answer(const Import& import) {
  std::string answer;
  for (const Part& part : import.parts) {
    const std::string stl = to_stl(part);
    answer += "part " + color_text(part.color) + " " + std::to_string(stl.size()) + "\n" + stl;
  }
  if (import.textured) answer += "textured\n";
  return answer + "end\n";
}

}  // namespace visum::collada
