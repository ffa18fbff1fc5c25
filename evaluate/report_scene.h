#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// What the report shows in 3D: samples as several views of the cloth on their body, with fields to colour them by.
/// Numbers are stored in 16 bits between the lowest and the highest, which leaves a body of 2 m an error of 0.02 mm.
namespace toile::evaluate {

/// Binary data of the page: `<script type="application/octet-stream" id="blob-7">`, base64 of zlib-deflated bytes.
struct ReportBlob {
    std::string id, text;
};

/// Numbers as 16-bit steps from `low` to `high`, each `count` of them.
struct PackedNumbers {
    std::string blob;
    std::vector<double> low, high;  ///< one, or one for each of x, y, z
    std::int64_t count = 0;         ///< vertices
};

struct SceneView {
    std::string key, name;  ///< "inextensibility", "after the inextensibility prior"
};

struct SceneField {
    std::string key, name, unit;
    double low = 0, high = 1;        ///< of the colours
    std::string map = "sequential";  ///< "stretch" (blue, white, red), "sequential", "diverging"
};

struct SceneCloth {
    std::string view;
    PackedNumbers position;
    std::vector<std::pair<std::string, PackedNumbers>> fields;  ///< by key
};

struct SceneImage {
    std::string name, src;  ///< src: a data URI
};

struct SceneSample {
    std::int64_t id = 0;
    std::string split;
    std::vector<std::pair<std::string, double>> error_mm;  ///< of a view, root mean square over vertices
    std::optional<PackedNumbers> body;
    std::vector<SceneCloth> cloth;
    std::vector<SceneImage> image;
};

struct ReportScene {
    std::string triangle, body_triangle;  ///< blobs of int32; the latter is empty where there is no body
    std::vector<SceneView> views;
    std::vector<SceneField> fields;
    std::vector<SceneSample> samples;
    std::optional<PackedNumbers> mu;  ///< of each vertex
};

/// Collects the blobs while a scene is made; ids are blob-0, blob-1, …
class BlobStore {
  public:
    /// `[N x columns]`, row-major. A number that is not finite is stored as the lowest.
    PackedNumbers pack(const std::vector<float>& value, int columns);
    std::string pack(const std::vector<std::int32_t>& value);

    const std::vector<ReportBlob>& blobs() const { return blobs_; }
    size_t bytes() const;  ///< of all, as they stand in the page

  private:
    std::string add(const std::vector<std::uint8_t>& bytes);
    std::vector<ReportBlob> blobs_;
};

/// The page's JSON.
nlohmann::ordered_json as_json(const ReportScene& scene);

}  // namespace toile::evaluate
