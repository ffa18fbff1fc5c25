#include "evaluate/strain_frames.h"

#include <glob.h>
#include <strings.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <utility>

#include "cloth/error.h"
#include "files/dataset_file.h"
#include "files/mesh_frame.h"
#include "files/mesh_group.h"

namespace toile::evaluate {
namespace {

constexpr std::array<const char*, 3> split_names = {"train", "validation", "test"};

bool is_mesh_name(const std::filesystem::path& path) {
    const std::string extension = path.extension().string();
    return ::strcasecmp(extension.c_str(), ".obj") == 0 || ::strcasecmp(extension.c_str(), ".ply") == 0;
}

/// "frame_9" comes before "frame_10".
bool comes_before(const std::string& a, const std::string& b) {
    const int order = ::strverscmp(a.c_str(), b.c_str());
    return order != 0 ? order < 0 : a < b;
}

std::vector<std::string> files_in(const std::string& folder) {
    std::vector<std::string> found;
    std::error_code failure;
    for (const auto& entry : std::filesystem::directory_iterator(folder, failure))
        if (!entry.is_directory() && is_mesh_name(entry.path())) found.push_back(entry.path().string());
    if (failure) throw Error("cannot read the folder: " + failure.message(), folder);
    if (found.empty()) throw Error("the folder has no .obj or .ply file", folder);
    return found;
}

std::vector<std::string> files_matching(const std::string& pattern) {
    glob_t match{};
    const int outcome = ::glob(pattern.c_str(), 0, nullptr, &match);
    std::vector<std::string> found;
    if (outcome == 0) found.assign(match.gl_pathv, match.gl_pathv + match.gl_pathc);
    ::globfree(&match);
    if (outcome != 0 && outcome != GLOB_NOMATCH) throw Error("cannot look for files of this pattern", pattern);
    if (found.empty()) throw Error("no file matches the pattern", pattern);
    return found;
}

ClothMesh read_rest(const std::string& path) {
    if (!is_mesh_name(path)) return files::read_mesh_group(files::Hdf5File::open(path));
    files::MeshFrame frame = files::read_mesh_frame(path);
    ClothMesh mesh;
    mesh.triangle = std::move(frame.triangle);
    mesh.rest_position = std::move(frame.position);
    return mesh;
}

class MeshFrames : public StrainFrames {
  public:
    MeshFrames(const std::string& rest, const std::vector<std::string>& sequence)
        : file_(sequence_files(sequence)),
          rest_name_(rest.empty() ? file_.front() : rest),
          mesh_(read_rest(rest_name_)) {}

    int count() const override { return static_cast<int>(file_.size()); }
    std::string name(int k) const override { return file_.at(k); }
    const ClothMesh& mesh() const override { return mesh_; }
    const std::string& rest_name() const override { return rest_name_; }
    std::vector<std::string> notes() const override { return {}; }

    Positions read(int k) const override {
        files::MeshFrame frame = files::read_mesh_frame(file_.at(k));
        const char* const mend = "all frames must have the vertices and triangles of the rest state, in its order";
        if (frame.position.rows() != mesh_.vertex_count())
            throw Error("the mesh has " + std::to_string(frame.position.rows()) + " vertices, the rest state " +
                            std::to_string(mesh_.vertex_count()) + which(k),
                        file_[k], mend);
        if (frame.triangle.rows() != mesh_.triangle_count())
            throw Error("the mesh has " + std::to_string(frame.triangle.rows()) + " triangles, the rest state " +
                            std::to_string(mesh_.triangle_count()) + which(k),
                        file_[k], mend);
        for (int f = 0; f < mesh_.triangle_count(); ++f)
            if (frame.triangle.row(f) != mesh_.triangle.row(f))
                throw Error("triangle " + std::to_string(f) + " joins other vertices than at rest" + which(k), file_[k],
                            mend);
        return std::move(frame.position);
    }

  private:
    std::string which(int k) const {
        return count() > 1 ? "; this is frame " + std::to_string(k) + ", the first that differs" : "";
    }

    std::vector<std::string> file_;
    std::string rest_name_;
    ClothMesh mesh_;
};

class DatasetFrames : public StrainFrames {
  public:
    DatasetFrames(const std::string& dataset, const std::vector<std::string>& split)
        : reader_(dataset), rest_name_(dataset) {
        const std::vector<int8_t> part = reader_.file().read<int8_t>("/samples/split").value;
        const std::vector<int8_t> status = reader_.file().read<int8_t>("/samples/status").value;
        const std::vector<int64_t> id = reader_.file().read<int64_t>("/samples/id").value;
        for (size_t slot = 0; slot < status.size(); ++slot) {
            const bool wanted = split.empty() || (part.at(slot) >= 0 && part[slot] < 3 &&
                                                  std::count(split.begin(), split.end(), split_names[part[slot]]) > 0);
            if (wanted && status[slot] == 0) sample_.push_back({static_cast<int64_t>(slot), id.at(slot)});
            if (wanted && status[slot] != 0) ++not_accepted_;
        }
        if (sample_.empty())
            throw Error(split.empty() ? "the data set has no accepted sample" : "the splits have no accepted sample",
                        dataset);
    }

    int count() const override { return static_cast<int>(sample_.size()); }
    std::string name(int k) const override { return "sample " + std::to_string(sample_.at(k).id); }
    const ClothMesh& mesh() const override { return reader_.header().mesh; }
    const std::string& rest_name() const override { return rest_name_; }
    std::vector<std::string> notes() const override {
        if (not_accepted_ == 0) return {};
        return {std::to_string(not_accepted_) + " samples that were not accepted are passed over"};
    }

    Positions read(int k) const override {
        const std::vector<double> value =
            reader_.file().read_rows<double>("/samples/cloth", sample_.at(k).slot, 1).value;
        Positions position = Eigen::Map<const Positions>(value.data(), static_cast<Eigen::Index>(value.size() / 3), 3);
        if (position.rows() != mesh().vertex_count() || !position.allFinite())
            throw Error("the cloth of " + name(k) + " is not finite", rest_name_ + ":/samples/cloth",
                        "toile validate tells what else is wrong");
        return position;
    }

  private:
    struct Sample {
        int64_t slot = 0, id = 0;
    };
    files::DatasetReader reader_;
    std::string rest_name_;
    std::vector<Sample> sample_;
    int not_accepted_ = 0;
};

}  // namespace

std::vector<std::string> sequence_files(const std::vector<std::string>& sequence) {
    std::vector<std::string> all;
    for (const std::string& entry : sequence) {
        std::vector<std::string> found;
        if (std::filesystem::is_directory(entry))
            found = files_in(entry);
        else if (entry.find_first_of("*?[") != std::string::npos && !std::filesystem::exists(entry))
            found = files_matching(entry);
        else
            found = {entry};
        std::sort(found.begin(), found.end(), comes_before);
        all.insert(all.end(), found.begin(), found.end());
    }
    if (all.empty()) throw Error("the sequence is empty", "command line");
    return all;
}

std::unique_ptr<StrainFrames> mesh_frames(const std::string& rest, const std::vector<std::string>& sequence) {
    return std::make_unique<MeshFrames>(rest, sequence);
}

std::unique_ptr<StrainFrames> dataset_frames(const std::string& dataset, const std::vector<std::string>& split) {
    return std::make_unique<DatasetFrames>(dataset, split);
}

}  // namespace toile::evaluate
