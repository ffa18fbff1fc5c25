#include "cloth/error.h"
#include "generate/scene_tables.h"

namespace toile::generate {

using files::ConfigTable;

files::ConfigChoices<std::string> axis_choices() {
    return {{"auto", "auto"}, {"x", "x"}, {"y", "y"}, {"z", "z"}, {"-x", "-x"}, {"-y", "-y"}, {"-z", "-z"}};
}

namespace {

skin::Role role_of(const ConfigTable& table, std::string_view key, const std::string& name) {
    try {
        return skin::role_from_name(name);
    } catch (const Error& error) {
        throw Error(error.what(), table.where(key), error.mend());
    }
}

/// A table of joint names by role.
void bind_role_names(ConfigTable& parent, std::string_view name, std::map<skin::Role, std::string>& joint) {
    auto table = parent.table(name, "joint names for roles; the others are found by name");
    if (!table) return;
    for (const std::string& role : table->keys())
        table->text(role, joint[role_of(*table, role, role)], "a joint's name");
}

void bind_builtin(ConfigTable& table, skin::BuiltinBodyOptions& b) {
    table.real("height", b.height, {.lower = 1.2, .upper = 2.2, .unit = "m"});
    table.real("girth", b.girth, {.lower = 0.7, .upper = 1.4, .doc = "scales the thickness of trunk and limbs"});
    table.real("voxel", b.voxel, {.lower = 0.008, .upper = 0.03, .unit = "m", .doc = "resolution of the surface"});
}

void bind_rigged(ConfigTable& table, BodyConfig& body) {
    skin::RiggedBodyOptions& r = body.rigged_options;
    table.path("file", body.file, "glTF, FBX or Collada with a skin");
    if (body.file.written.empty()) table.fail("file", "is missing: body.source is \"file\"");
    table.choice<std::string>("up", r.up, axis_choices(), "axis of the file that points up");
    table.real("metres_per_unit", r.metres_per_unit,
               {.lower = 0, .upper = 1000, .unit = "m", .doc = "length of the file's unit; 0: found out"});
    table.texts("mesh", r.mesh, "names of the meshes to join; none: all that have a skin");
    bind_role_names(table, "roles", r.role);
}

}  // namespace

void bind_body(ConfigTable& root, SceneConfig& config) {
    auto table = root.table("body", "what the garment is worn on");
    if (!table) return;
    config.body.emplace();
    BodyConfig& body = *config.body;
    table->choice<bool>("source", body.builtin, {{"builtin", true}, {"file", false}}, "made by code, or a rigged body");
    if (body.builtin)
        bind_builtin(*table, body.builtin_options);
    else
        bind_rigged(*table, body);
    table->choice<skin::SkinningMethod>(
        "skinning", body.skinning,
        {{"linear", skin::SkinningMethod::linear}, {"dual_quaternion", skin::SkinningMethod::dual_quaternion}},
        "how joints carry the surface");
    if (body.builtin) body.licence = "MIT, made by toile's code";
    table->text("licence", body.licence, "under which the body's shape may be used, for the data card");
}

namespace {

/// [poses.limits]: for each role raise, swing and twist as [lower, upper].
void bind_limits(ConfigTable& poses, skin::SamplerOptions& sampler) {
    auto table = poses.table("limits", "joint limits by role, in place of the usual ones");
    if (!table) return;
    for (const std::string& name : table->keys()) {
        const skin::Role role = role_of(*table, name, name);
        ConfigTable limit = table->section(name, "");
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
    for (const std::string& one : word) sampler.roles.push_back(role_of(poses, "roles", one));
}

/// How many poses a sampler makes, or at most are taken from a file, and which.
void bind_selection(ConfigTable& table, PosesConfig& poses) {
    const files::ConfigField field{.lower = 1, .upper = 10000000, .doc = "samples"};
    if (poses.source == PoseSource::sampler) {
        table.integer("count", poses.count, field);
    } else {
        std::optional<int> most;
        table.integer_or("count", most, "all", field);
        poses.selection.most = most;
    }
    std::vector<int> number;
    table.integers("number", number, {.lower = 0, .doc = "pose numbers wanted; none: all of them"});
    poses.selection.number.assign(number.begin(), number.end());
}

void bind_motion(ConfigTable& table, skin::MotionOptions& m) {
    table.integer("first_frame", m.first_frame, {.lower = 0});
    table.integer("last_frame", m.last_frame, {.lower = -1, .doc = "-1: the motion's last"});
    table.integer("stride", m.stride, {.lower = 1, .doc = "every so many frames"});
    table.real("rate", m.rate,
               {.lower = 0, .upper = 10000, .unit = "1/s", .doc = "poses a second; 0: the motion's own"});
    table.choice<std::string>("up", m.up, axis_choices(), "axis of the motion that points up");
    table.real("metres_per_unit", m.metres_per_unit,
               {.lower = 0, .upper = 1000, .unit = "m", .doc = "length of the motion's unit; 0: found out"});
    bind_role_names(table, "joints", m.joint);
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
    bind_selection(*table, poses);
    table->real("arm_clearance", poses.arm_clearance,
                {.lower = 0,
                 .upper = 0.1,
                 .unit = "m",
                 .doc = "arms that come nearer to the trunk are turned away from it; 0: poses as they are"});
    if (poses.source == PoseSource::sampler) {
        bind_roles(*table, poses.sampler);
        table->boolean("symmetric", poses.sampler.symmetric, "right limbs copy left ones");
        bind_limits(*table, poses.sampler);
        poses.sampler.seed = config.seed;
        return;
    }
    table->path("file", poses.file, "the motion (.bvh) or table (.csv, .h5)");
    if (poses.file.written.empty()) table->fail("file", "is missing: poses.source asks for one");
    if (poses.source == PoseSource::bvh) bind_motion(*table, poses.motion);
}

}  // namespace toile::generate
