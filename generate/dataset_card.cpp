#include "generate/dataset_card.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>

#include "cloth/error.h"
#include "files/config_file.h"
#include "files/dataset_file.h"
#include "files/digest.h"
#include "files/image_file.h"
#include "files/new_file.h"
#include "generate/distribution.h"
#include "generate/sample_sheet.h"
#include "generate/sample_tally.h"

namespace toile::generate {

namespace fs = std::filesystem;

namespace {

constexpr const char* split_name[3] = {"train", "validation", "test"};
constexpr int listed = 10;   // pose numbers of a reason
constexpr size_t shown = 8;  // samples, where there are as many

/// The data set's columns.
struct Columns {
    explicit Columns(const files::DatasetReader& reader) : file(reader.file()) {
        id = file.read<std::int64_t>("/samples/id", {files::any_size}).value;
        split = file.read<int>("/samples/split", {files::any_size}).value;
        status = file.read<int>("/samples/status", {files::any_size}).value;
    }
    /// Of /certificate, as numbers.
    std::vector<double> certificate(const std::string& name) const {
        const std::string dataset = "/certificate/" + name;
        if (file.type_name(dataset).starts_with("float")) return file.read<double>(dataset, {files::any_size}).value;
        const std::vector<std::int64_t> value = file.read<std::int64_t>(dataset, {files::any_size}).value;
        return {value.begin(), value.end()};
    }
    std::vector<double> accepted(const std::vector<double>& value) const {
        std::vector<double> kept;
        for (size_t i = 0; i < value.size(); ++i)
            if (status[i] == 0) kept.push_back(value[i]);
        return kept;
    }

    const files::Hdf5File& file;
    std::vector<std::int64_t> id;
    std::vector<int> split, status;
};

/// What the card is written from.
struct Card {
    const std::string& dataset;
    const CardOptions& options;
    const files::DatasetReader& reader;
    const files::DatasetHeader& header;
    const Columns& columns;
    std::string text = {};

    template <class... Args>
    void say(fmt::format_string<Args...> format, Args&&... args) {
        text += fmt::format(format, std::forward<Args>(args)...) + "\n";
    }
    std::string folder() const { return fs::path(dataset).parent_path().string(); }
};

/// A text of the stored configuration, or `otherwise`.
std::string setting(const Card& card, const char* table, const char* key, const std::string& otherwise) {
    std::string value;
    try {
        const files::ConfigFile config = files::ConfigFile::from_text(card.header.config, card.dataset, {});
        if (auto found = config.root().table(table, "")) found->text(key, value, "");
    } catch (const Error&) {  // a file of another program version: its configuration is shown as it is
    }
    return value.empty() ? otherwise : value;
}

/// The lines of a table of the configuration, without its heading; empty where it has none.
std::string section(const std::string& config, const std::string& table) {
    const size_t at = ("\n" + config).find("\n[" + table + "]");
    if (at == std::string::npos) return {};
    const size_t first = config.find('\n', at) + 1, end = config.find("\n[", at);
    return config.substr(first, end == std::string::npos ? end : end - first);
}

void say_splits(Card& card) {
    std::map<int, std::pair<int, int>> count;  // split -> accepted, all
    for (size_t i = 0; i < card.columns.split.size(); ++i) {
        auto& [accepted, all] = count[card.columns.split[i]];
        ++all;
        accepted += card.columns.status[i] == 0;
    }
    card.say("## Samples\n\n| split | accepted | failed | all |\n|---|---:|---:|---:|");
    int accepted_sum = 0, sum = 0;
    for (int s = 0; s < 3; ++s) {
        const auto [accepted, all] = count[s];
        card.say("| {} | {} | {} | {} |", split_name[s], accepted, all - accepted, all);
        accepted_sum += accepted;
        sum += all;
    }
    card.say("| all | {} | {} | {} |\n", accepted_sum, sum - accepted_sum, sum);
    card.say(
        "Poses nearer than {:g} rad in every joint belong to one split. Failed samples stay in the file with their "
        "status: train on status 0.\n",
        card.header.duplicate_angle);
}

void say_failures(Card& card) {
    std::map<int, std::vector<std::int64_t>> pose;
    for (size_t i = 0; i < card.columns.status.size(); ++i)
        if (card.columns.status[i] != 0) pose[card.columns.status[i]].push_back(card.columns.id[i]);
    if (pose.empty()) return;
    card.say("## Failures\n\n| reason | samples | pose numbers |\n|---|---:|---|");
    for (auto& [status, number] : pose) {
        std::sort(number.begin(), number.end());
        std::string list;
        for (size_t i = 0; i < std::min<size_t>(number.size(), listed); ++i)
            list += (i > 0 ? ", " : "") + std::to_string(number[i]);
        if (number.size() > listed) list += ", ...";
        const bool known = status > 0 && status < static_cast<int>(card.header.reasons.size());
        card.say("| {} | {} | {} |", known ? card.header.reasons[status] : "status " + std::to_string(status),
                 number.size(), list);
    }
    const std::int64_t first = pose.begin()->second.front();
    const std::string replay = replay_path(card.folder(), first);
    if (fs::exists(replay))
        card.say("\nEach is kept in `replay/`; `toile simulate --replay {} --out pose.obj` runs one again.",
                 fs::path(replay).lexically_relative(card.folder()).generic_string());
    card.say("");
}

struct Measure {
    const char* name;
    const char* unit;
};

void say_certificate(Card& card) {
    static const std::vector<Measure> measure{{"residual_force", "of the weight"},
                                              {"max_speed", "m/s"},
                                              {"moving_share", "of the vertices"},
                                              {"body_penetration", "m"},
                                              {"body_crossings", "triangle pairs"},
                                              {"self_intersections", "triangle pairs"},
                                              {"max_stretch", "length / rest length"},
                                              {"iterations", ""},
                                              {"path_steps", ""},
                                              {"tries", ""},
                                              {"seconds", "s"}};
    card.say(
        "## Certificate\n\nOver the accepted samples; percentiles by nearest rank. `seconds` is the wall time of a "
        "drape, the one figure here that another run changes.\n");
    card.say("| | unit | median | 95 % | 99 % | largest | gate |\n|---|---|---:|---:|---:|---:|---:|");
    for (const Measure& one : measure) {
        if (!card.reader.file().has(std::string("/certificate/") + one.name)) continue;
        const std::vector<double> value = card.columns.accepted(card.columns.certificate(one.name));
        if (value.empty()) continue;
        const Distribution d = distribution(value);
        const auto bound = card.header.gate.find(one.name);
        card.say("| `{}` | {} | {:.4g} | {:.4g} | {:.4g} | {:.4g} | {} |", one.name, one.unit, d.median, d.ninety_fifth,
                 d.ninety_ninth, d.largest,
                 bound == card.header.gate.end() ? "" : fmt::format("{:.4g}", bound->second));
    }
    const std::vector<double> smallest = card.columns.accepted(card.columns.certificate("min_stretch"));
    if (!smallest.empty()) {
        const Distribution d = distribution(smallest);
        card.say("\n| | unit | median | 5 % | 1 % | smallest |\n|---|---|---:|---:|---:|---:|");
        card.say("| `min_stretch` | length / rest length | {:.4g} | {:.4g} | {:.4g} | {:.4g} |", d.median, d.fifth,
                 d.first, d.smallest);
    }
    card.say("");
}

/// The data set's file, the one with its times, and the parts that a joined one refers to.
std::uintmax_t bytes_on_disk(const std::string& dataset, const files::Hdf5File& file) {
    std::set<fs::path> path = {dataset, files::timing_path(dataset)};
    for (const files::VirtualRows& rows : file.virtual_rows("/samples/cloth"))
        path.insert(fs::path(dataset).parent_path() / rows.file);
    std::uintmax_t bytes = 0;
    for (const fs::path& one : path) {
        std::error_code none;
        const std::uintmax_t size = fs::file_size(one, none);
        if (!none) bytes += size;
    }
    return bytes;
}

void say_sizes(Card& card) {
    const int samples = card.reader.sample_count();
    const double bytes = static_cast<double>(bytes_on_disk(card.dataset, card.reader.file()));
    card.say("## Sizes\n\n| | |\n|---|---|");
    card.say("| cloth | {} vertices, {} triangles |", card.header.mesh.vertex_count(),
             card.header.mesh.triangle_count());
    if (card.header.body)
        card.say("| body | {} vertices, {} triangles, {} joints |", card.header.body->rest_position.rows(),
                 card.header.body->triangle.rows(), card.header.body->joint_name.size());
    if (card.header.image) {
        const files::DatasetImage& image = *card.header.image;
        card.say("| images | {0} x {0} pixels, {1} channels |", image.size, 3 * image.layers);
        if (card.header.resampling_error)
            card.say("| read back from the image | within {:.3g} mm, root mean square {:.3g} mm |",
                     1e3 * (*card.header.resampling_error)[0], 1e3 * (*card.header.resampling_error)[1]);
    }
    card.say("| disk | {:.4g} MB, {:.4g} kB a sample |\n", 1e-6 * bytes, samples > 0 ? 1e-3 * bytes / samples : 0.0);
}

void say_conventions(Card& card) {
    card.say(
        "## Units and axes\n\nMetres, kilograms, seconds, radians. Right-handed, y up, the body faces +z; body and "
        "cloth are in one frame. Positions and displacements of samples are 32-bit floats, the rest 64-bit.\n");
    if (card.header.body)
        card.say(
            "`/samples/pose` holds axis-angle rotations of the joints from the bind pose, each in its joint's own "
            "frame.");
    if (card.header.embedding)
        card.say(
            "`/samples/displacement` is (along u, along v, outwards) in each vertex's `/samples/frame`: cloth = "
            "embedded + q d q⁻¹.");
    if (card.header.image)
        card.say(
            "Channel 3 layer + component of `/samples/image` is that displacement in metres, read bilinearly at "
            "`/image/pattern_pixel`; pixel centres are at whole numbers.");
    card.say("");
}

void say_materials(Card& card) {
    std::string all;
    for (const char* table : {"material", "bending", "strain_limit", "contact", "self_contact", "wind"})
        if (const std::string lines = section(card.header.config, table); !lines.empty())
            all += fmt::format("[{}]\n{}\n", table, lines.substr(0, lines.find_last_not_of('\n') + 1));
    if (!all.empty()) card.say("## Materials\n\n```toml\n{}```\n", all);
}

void say_licences(Card& card) {
    card.say("## Licences\n\n| | licence |\n|---|---|");
    if (card.header.body) card.say("| body | {} |", setting(card, "body", "licence", "not stated"));
    card.say("| garment | {} |\n", setting(card, "garment", "licence", "not stated"));
}

void say_origin(Card& card) {
    card.say("## How it was made\n\n| | |\n|---|---|\n| program | toile {} |", card.header.program_version);
    if (!card.options.command.empty()) card.say("| command | `{}` |", card.options.command);
    card.say("| seed | {} |\n| digest of the configuration and its files | `{}` |", card.header.seed,
             card.header.config_hash);
    card.say("| digest of all samples (XXH3-128 of `/samples/digest` in the order of the ids) | `{}` |\n",
             corpus_digest(card.dataset));
    for (const std::string& remark : card.options.remarks) card.say("- {}", remark);
    if (!card.options.remarks.empty()) card.say("");
    card.say("The resolved configuration:\n\n```toml\n{}\n```",
             card.header.config.substr(0, card.header.config.find_last_not_of('\n') + 1));
}

/// Draws the sheet; false where no sample can be shown.
bool write_sheet(Card& card, const std::string& path) {
    const std::vector<double> stretch = card.columns.certificate("max_stretch");
    const std::vector<double> penetration = card.columns.certificate("body_penetration");
    std::vector<SheetTile> tile;
    for (const int slot : card_slots(card.columns.split, card.columns.status, stretch, penetration))
        tile.push_back(
            {slot, fmt::format("pose {}, {}\nstretch to {:.3f}, {:.3f} mm into the body", card.columns.id[slot],
                               split_name[card.columns.split[slot]], stretch[slot], 1e3 * penetration[slot])});
    if (tile.empty()) return false;
    files::write_png(path, sample_sheet(card.reader, tile));
    return true;
}

}  // namespace

std::vector<int> card_slots(const std::vector<int>& split, const std::vector<int>& status,
                            const std::vector<double>& max_stretch, const std::vector<double>& body_penetration) {
    std::vector<int> of[3], all, slot;
    int stretched = -1, deepest = -1;
    for (int i = 0; i < static_cast<int>(split.size()); ++i) {
        if (status[i] != 0 || split[i] < 0 || split[i] > 2) continue;
        of[split[i]].push_back(i);
        all.push_back(i);
        if (stretched < 0 || max_stretch[i] > max_stretch[stretched]) stretched = i;
        if (deepest < 0 || body_penetration[i] > body_penetration[deepest]) deepest = i;
    }
    const auto add = [&](int i) {
        if (i >= 0 && std::find(slot.begin(), slot.end(), i) == slot.end()) slot.push_back(i);
    };
    for (const std::vector<int>& one : of) {
        if (!one.empty()) add(one.front());
        if (!one.empty()) add(one[one.size() / 2]);
    }
    add(stretched);
    add(deepest);
    for (size_t i = 0; i < all.size() && slot.size() < shown; ++i)
        add(all[(2 * i + 1) * all.size() / shown / 2 % all.size()]);
    for (size_t i = 0; i < all.size() && slot.size() < shown; ++i) add(all[i]);
    std::sort(slot.begin(), slot.end());
    return slot;
}

std::string corpus_digest(const std::string& dataset) {
    const files::Hdf5File file = files::Hdf5File::open(dataset);
    const std::vector<std::int64_t> id = file.read<std::int64_t>("/samples/id", {files::any_size}).value;
    const std::vector<std::uint8_t> digest = file.read<std::uint8_t>("/samples/digest", {files::any_size, 16}).value;
    std::vector<size_t> order(id.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return id[a] < id[b]; });
    std::string all;
    for (const size_t i : order)
        all.append(reinterpret_cast<const char*>(digest.data()) + 16 * i, 16);  // bytes as they are stored
    return files::text_digest(all);
}

std::vector<std::string> write_card(const std::string& dataset, const CardOptions& options) {
    const files::DatasetReader reader(dataset);
    const Columns columns(reader);
    Card card{dataset, options, reader, reader.header(), columns};
    const fs::path folder = fs::path(dataset).parent_path();
    std::vector<std::string> written;
    card.say("# {}\n\nDraped cloth on posed bodies: {} samples in `{}`.\n", setting(card, "scene", "name", "data set"),
             reader.sample_count(), fs::path(dataset).filename().string());
    const std::string sheet = (folder / "samples.png").string();
    if (write_sheet(card, sheet)) {
        written.push_back(sheet);
        card.say(
            "![Body and cloth of a few samples, coloured by stretch](samples.png)\n\nOf each split two samples, then "
            "the worst accepted ones by stretch and by penetration. The cloth is white at its rest length, red "
            "where it is stretched to 1.25 times, blue where it is squeezed to 0.75.\n");
    }
    say_splits(card);
    say_failures(card);
    say_certificate(card);
    say_sizes(card);
    say_conventions(card);
    say_materials(card);
    say_licences(card);
    say_origin(card);
    written.push_back((folder / "CARD.md").string());
    files::write_text_file(written.back(), card.text);
    return written;
}

}  // namespace toile::generate
