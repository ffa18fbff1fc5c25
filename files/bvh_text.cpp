#include "files/bvh_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "cloth/error.h"

namespace toile::files {
namespace {

constexpr int deepest_chain = 200;
constexpr int most_channels = 6;

bool is_space(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/// The start of a word, fit for a message.
std::string shown(std::string_view word) {
    std::string text = "'";
    for (const char c : word.substr(0, 40)) text += c > ' ' && c < 127 ? c : '?';
    return text + "'";
}

/// Words of the text, split as assimp splits them, with the line they stand on.
class Words {
  public:
    Words(std::string& text, const std::string& path) : text_(text), path_(path) {}

    /// The next word, empty at the end.
    std::string_view next() {
        while (at_ < text_.size() && is_space(text_[at_])) line_ += text_[at_++] == '\n';
        const std::size_t begin = at_;
        while (at_ < text_.size() && !is_space(text_[at_])) {
            ++at_;
            if (at_ == begin + 1 && (text_[begin] == '{' || text_[begin] == '}')) break;
        }
        return std::string_view(text_).substr(begin, at_ - begin);
    }

    /// Reads the rest of the line as one name, joining its words with underscores.
    void join_name() {
        const std::string_view first = next();
        if (first.empty() || first == "{") refuse("a joint without a name");
        while (true) {
            std::size_t word = at_;
            while (word < text_.size() && (text_[word] == ' ' || text_[word] == '\t')) ++word;
            if (word == text_.size() || is_space(text_[word]) || text_[word] == '{') return;
            for (; at_ < word; ++at_) text_[at_] = '_';
            while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
        }
    }

    double to_number(std::string_view word, const char* what) const {
        std::string_view digits = word;
        if (digits.starts_with('+')) digits.remove_prefix(1);
        double value = 0;
        const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (end.ec != std::errc() || end.ptr != digits.data() + digits.size() || !std::isfinite(value))
            refuse(std::string(what) + " should be a number, but is " + shown(word));
        return value;
    }

    double number(const char* what) { return to_number(next(), what); }

    int count(const char* what, int least, int most) {
        const double value = number(what);
        if (value != std::floor(value) || value < least || value > most)
            refuse(std::string(what) + " should be a whole number from " + std::to_string(least) + " to " +
                   std::to_string(most));
        return static_cast<int>(value);
    }

    void expect(std::string_view word) {
        const std::string_view found = next();
        if (found != word) refuse(shown(word) + " should stand here, not " + shown(found));
    }

    [[noreturn]] void refuse(const std::string& what) const {
        throw Error("not a readable BVH: " + what, path_ + ":" + std::to_string(line_));
    }

  private:
    std::string& text_;
    const std::string& path_;
    std::size_t at_ = 0;
    int line_ = 1;
};

std::string read_text(const std::string& path) {
    if (std::filesystem::is_directory(path)) throw Error("a folder, not a BVH file", path);
    std::ifstream file(path, std::ios::binary);
    if (!file) throw Error("the motion file cannot be opened", path);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    std::string text = bytes.str();
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
    if (text.find_first_not_of(" \t\r\n") == std::string::npos) throw Error("the motion file is empty", path);
    return text;
}

void scan_offset(Words& words) {
    for (int axis = 0; axis < 3; ++axis) words.number("an offset");
}

int scan_channels(Words& words) {
    constexpr std::array<std::string_view, 6> known = {"Xposition", "Yposition", "Zposition",
                                                       "Xrotation", "Yrotation", "Zrotation"};
    const int count = words.count("the number of channels", 0, most_channels);
    std::set<std::string_view> used;
    for (int i = 0; i < count; ++i) {
        const std::string_view name = words.next();
        if (std::find(known.begin(), known.end(), name) == known.end())
            words.refuse("a channel should be Xposition ... Zrotation, not " + shown(name));
        if (!used.insert(name).second) words.refuse("the channel " + shown(name) + " stands twice at one joint");
    }
    return count;
}

/// What a joint has been given so far. The order matters to assimp: offset, channels, then children.
struct OpenJoint {
    bool offset = false, channels = false, child = false;
};

void scan_joint_entry(Words& words, std::string_view entry, OpenJoint& joint, BvhText& bvh) {
    if (entry == "OFFSET") {
        if (std::exchange(joint.offset, true)) words.refuse("a second OFFSET at one joint");
        scan_offset(words);
    } else if (entry == "CHANNELS") {
        if (std::exchange(joint.channels, true)) words.refuse("a second CHANNELS at one joint");
        if (joint.child) words.refuse("CHANNELS should stand before a joint's children");
        bvh.channel_count += scan_channels(words);
    } else if (entry == "End") {
        joint.child = true;
        for (const char* word : {"Site", "{", "OFFSET"}) words.expect(word);
        scan_offset(words);
        words.expect("}");
    } else {
        words.refuse("OFFSET, CHANNELS, JOINT, End Site or } should stand here, not " + shown(entry));
    }
}

/// Walks from ROOT to the brace that closes it.
void scan_hierarchy(Words& words, BvhText& bvh) {
    std::vector<OpenJoint> open;
    words.expect("ROOT");
    std::string_view entry = "ROOT";
    do {
        if (entry.empty()) words.refuse("the file ends within the hierarchy");
        if (entry == "JOINT" || open.empty()) {
            if (!open.empty()) open.back().child = true;
            if (open.size() == deepest_chain) words.refuse("joints are nested too deep");
            words.join_name();
            words.expect("{");
            open.emplace_back();
            ++bvh.joint_count;
        } else if (entry == "}") {
            if (!open.back().offset) words.refuse("a joint without an OFFSET");
            open.pop_back();
        } else {
            scan_joint_entry(words, entry, open.back(), bvh);
        }
        if (!open.empty()) entry = words.next();
    } while (!open.empty());
    if (bvh.channel_count == 0) words.refuse("no joint has a channel");
}

void scan_motion(Words& words, BvhText& bvh) {
    words.expect("MOTION");
    words.expect("Frames:");
    bvh.frame_count = words.count("the number of frames", 0, 1 << 30);
    if (bvh.frame_count == 0) words.refuse("the motion has no frame");
    words.expect("Frame");
    words.expect("Time:");
    bvh.frame_time = words.number("the frame time");
    if (bvh.frame_time < 0) words.refuse("the frame time is negative");

    const auto channels = static_cast<std::size_t>(bvh.channel_count);
    const std::size_t announced = static_cast<std::size_t>(bvh.frame_count) * channels;
    std::size_t values = 0;
    for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++values)
        words.to_number(word, "a value of the motion");
    const std::string frames = std::to_string(bvh.frame_count) + " frames of " + std::to_string(channels) + " values";
    if (values < announced)
        words.refuse("the file announces " + frames + ", but ends within frame " + std::to_string(values / channels));
    if ((values - announced) % channels != 0)
        words.refuse("the file announces " + frames + ", but holds " + std::to_string(values) + " values");
}

}  // namespace

BvhText read_bvh_text(const std::string& path) {
    BvhText bvh;
    bvh.text = read_text(path);
    Words words(bvh.text, path);
    if (words.next() != "HIERARCHY") throw Error("not a BVH file: it does not begin with HIERARCHY", path);
    scan_hierarchy(words, bvh);
    scan_motion(words, bvh);
    return bvh;
}

}  // namespace toile::files
