#include "cloth/error.h"
#include "generate/scene_tables.h"

namespace toile::generate {

using files::ConfigTable;

void bind_body(ConfigTable& root, SceneConfig& config) {
    auto table = root.table("body", "what the garment is worn on");
    if (!table) return;
    config.body.emplace();
    BodyConfig& body = *config.body;
    table->choice<bool>("source", body.builtin, {{"builtin", true}, {"file", false}}, "made by code, or a rigged body");
    if (body.builtin) {
        skin::BuiltinBodyOptions& b = body.builtin_options;
        table->real("height", b.height, {.lower = 1.2, .upper = 2.2, .unit = "m"});
        table->real("girth", b.girth, {.lower = 0.7, .upper = 1.4, .doc = "scales the thickness of trunk and limbs"});
        table->real("voxel", b.voxel, {.lower = 0.008, .upper = 0.03, .unit = "m", .doc = "resolution of the surface"});
    } else {
        table->path("file", body.file, "glTF, FBX or Collada with a skin");
        if (body.file.written.empty()) table->fail("file", "is missing: body.source is \"file\"");
    }
    table->choice<skin::SkinningMethod>(
        "skinning", body.skinning,
        {{"linear", skin::SkinningMethod::linear}, {"dual_quaternion", skin::SkinningMethod::dual_quaternion}},
        "how joints carry the surface");
}

namespace {

/// [poses.limits]: for each role raise, swing and twist as [lower, upper].
void bind_limits(ConfigTable& poses, skin::SamplerOptions& sampler) {
    auto table = poses.table("limits", "joint limits by role, in place of the usual ones");
    if (!table) return;
    for (const std::string& name : table->keys()) {
        const skin::Role role = [&] {
            try {
                return skin::role_from_name(name);
            } catch (const Error& error) {
                throw Error(error.what(), table->where(name), error.mend());
            }
        }();
        ConfigTable limit = *table->table(name, "raise, swing and twist");
        skin::JointLimit& value = sampler.limits.emplace(role, skin::default_limit(role)).first->second;
        const files::ConfigField field{.lower = -6.2832, .upper = 6.2832, .unit = "rad"};
        limit.interval("raise", value.lower[0], value.upper[0], field);
        limit.interval("swing", value.lower[1], value.upper[1], field);
        limit.interval("twist", value.lower[2], value.upper[2], field);
    }
}

void bind_roles(ConfigTable& poses, skin::SamplerOptions& sampler) {
    std::vector<std::string> word;
    for (const skin::Role role : sampler.roles) word.emplace_back(skin::role_name(role));
    poses.texts("roles", word, "the joints that move");
    sampler.roles.clear();
    try {
        for (const std::string& one : word) sampler.roles.push_back(skin::role_from_name(one));
    } catch (const Error& error) {
        throw Error(error.what(), poses.where("roles"), error.mend());
    }
}

}  // namespace

void bind_poses(ConfigTable& root, SceneConfig& config) {
    auto table = root.table("poses", "the postures the body takes");
    if (!table) return;
    config.poses.emplace();
    PosesConfig& poses = *config.poses;
    table->choice<PoseSource>(
        "source", poses.source,
        {{"sampler", PoseSource::sampler}, {"bvh", PoseSource::bvh}, {"table", PoseSource::table}},
        "evenly within joint limits, a motion, or a table of joint angles");
    table->integer("count", poses.count, {.lower = 1, .upper = 10000000, .doc = "samples"});
    if (poses.source == PoseSource::sampler) {
        bind_roles(*table, poses.sampler);
        table->boolean("symmetric", poses.sampler.symmetric, "right limbs copy left ones");
        bind_limits(*table, poses.sampler);
        poses.sampler.seed = config.seed;
        return;
    }
    table->path("file", poses.file, "the motion (.bvh) or table (.csv, .h5)");
    if (poses.file.written.empty()) table->fail("file", "is missing: poses.source asks for one");
}

}  // namespace toile::generate
