#include "skin/role_names.h"

#include <algorithm>
#include <cctype>
#include <set>

namespace toile::skin {
namespace {

using Words = std::set<std::string>;

const Words upper_arm_words = {"upperarm", "uparm", "uarm", "shldr", "humerus", "bicep", "biceps"};
const Words lower_arm_words = {"lowerarm", "loarm", "lowarm", "forearm", "elbow", "farm"};
const Words hand_words = {"hand", "wrist"};
const Words clavicle_words = {"clavicle", "collar", "clav", "collarbone", "scapula"};
const Words upper_leg_words = {"upperleg", "upleg", "thigh", "femur", "uleg"};
const Words lower_leg_words = {"lowerleg", "loleg", "lowleg", "calf", "shin", "knee", "tibia", "crus"};
const Words foot_words = {"foot", "ankle", "feet"};
const Words pelvis_words = {"pelvis", "hips", "hip"};
const Words spine_words = {"spine",      "lowerback", "upperback",    "back",      "chest", "upperchest",
                           "lowerchest", "torso",     "abdomen",      "waist",     "belly", "abdomenlower",
                           "stomach",    "lumbar",    "abdomenupper", "chestlower"};
const Words helper_words = {"twist", "roll",     "ik",      "pole",    "target", "end",   "nub",
                            "ctrl",  "tip",      "helper",  "control", "site",   "tweak", "corrective",
                            "mch",   "effector", "endsite", "fk",      "dummy"};
const Words ignored_words = {"mixamorig", "bip",  "j",     "def",       "org",     "avg", "m",
                             "f",         "c",    "cc",    "base",      "b",       "rig", "bone",
                             "bend",      "jnt",  "joint", "character", "n",       "bn",  "valvebiped",
                             "bind",      "skin", "sk",    "skeleton",  "armature"};

bool is_limb_word(const std::string& word) {
    static const Words weak = {"arm", "leg", "shoulder", "hip"};
    for (const Words* words : {&upper_arm_words, &lower_arm_words, &hand_words, &clavicle_words, &upper_leg_words,
                               &lower_leg_words, &foot_words, &weak})
        if (words->count(word)) return true;
    return false;
}

/// What a name says: the side (+1 left, -1 right, 0 neither) and the words without markers, prefixes and numbers.
struct ParsedName {
    int side = 0;
    bool helper = false;
    std::string word;
};

/// Cut at separators, between letters and digits, and where a capital starts a word; lower case.
std::vector<std::string> tokens_of(const std::string& name) {
    std::vector<std::string> tokens;
    std::string token;
    auto finish = [&] {
        if (!token.empty()) tokens.push_back(token);
        token.clear();
    };
    const size_t start = name.find_last_of(":|") == std::string::npos ? 0 : name.find_last_of(":|") + 1;
    for (size_t i = start; i < name.size(); ++i) {
        const unsigned char c = static_cast<unsigned char>(name[i]);
        const unsigned char before = i > start ? static_cast<unsigned char>(name[i - 1]) : ' ';
        const unsigned char after = i + 1 < name.size() ? static_cast<unsigned char>(name[i + 1]) : ' ';
        if (!std::isalnum(c)) {
            finish();
            continue;
        }
        const bool new_word =
            std::isupper(c) && (std::islower(before) || (std::isupper(before) && std::islower(after)));
        if (new_word || std::isdigit(c) != std::isdigit(before)) finish();
        token += static_cast<char>(std::tolower(c));
    }
    finish();
    return tokens;
}

/// The side a token stands for; a side written together with the word ("lefthip", "lshldr") is cut off it.
int take_side(std::string& token) {
    for (const auto& [marker, side] : {std::pair<std::string, int>{"left", 1}, {"right", -1}, {"l", 1}, {"r", -1}}) {
        if (token == marker || token == marker + "ft" || token == marker + "t") {
            token.clear();
            return side;
        }
        const std::string rest = token.starts_with(marker) ? token.substr(marker.size()) : "";
        if (is_limb_word(rest)) {
            token = rest;
            return side;
        }
    }
    return 0;
}

ParsedName parse(const std::string& name) {
    ParsedName parsed;
    for (std::string token : tokens_of(name)) {
        if (const int side = take_side(token)) parsed.side = side;
        parsed.helper = parsed.helper || helper_words.count(token);
        if (token.empty() || std::isdigit(static_cast<unsigned char>(token[0])) || ignored_words.count(token)) continue;
        parsed.word += token;
    }
    return parsed;
}

/// The search over one skeleton.
struct RoleSearch {
    const std::vector<NamedJoint>& joint;
    std::vector<ParsedName> name;
    RoleMap role;

    bool descends(int j, int ancestor) const {
        while (j >= 0 && j != ancestor) j = joint[j].parent;
        return j >= 0 && j == ancestor;
    }
    int depth(int j) const {
        int count = 0;
        for (; j >= 0; j = joint[j].parent) ++count;
        return count;
    }
    int common_ancestor(int a, int b) const {
        if (a < 0 || b < 0) return -1;
        while (a >= 0 && !descends(b, a)) a = joint[a].parent;
        return a;
    }

    /// The shallowest joint of that side and those words strictly below `above` (where that is a joint) and above
    /// `below` (likewise); -1 where there is none.
    int find(const Words& words, int side, int above = -1, int below = -1) const {
        int best = -1;
        for (int j = 0; j < static_cast<int>(joint.size()); ++j) {
            if (name[j].helper || name[j].side != side || !words.count(name[j].word)) continue;
            if (above >= 0 && (j == above || !descends(j, above))) continue;
            if (below >= 0 && (j == below || !descends(below, j))) continue;
            if (best < 0 || depth(j) < depth(best)) best = j;
        }
        return best;
    }

    void set(Role which, int found) {
        if (role[which] < 0) role[which] = found;
    }

    void find_arm(int side, Role clavicle) {
        const Role upper = static_cast<Role>(static_cast<int>(clavicle) + 1);
        const Role lower = static_cast<Role>(static_cast<int>(clavicle) + 2);
        const Role hand = static_cast<Role>(static_cast<int>(clavicle) + 3);
        set(lower, find(lower_arm_words, side, role[upper]));
        set(upper, find(upper_arm_words, side, role[clavicle], role[lower]));
        set(upper, find({"arm"}, side, role[clavicle], role[lower]));
        // "Shoulder" names the upper arm in SMPL, the clavicle in Mixamo: the deeper of two carries the arm.
        if (role[upper] < 0) {
            const int collar = role[clavicle] >= 0 ? role[clavicle] : find(clavicle_words, side);
            set(upper, find({"shoulder"}, side, collar, role[lower]));
        }
        set(clavicle, find(clavicle_words, side, -1, role[upper]));
        set(clavicle, find({"shoulder"}, side, -1, role[upper]));
        if (role[upper] >= 0) set(hand, find(hand_words, side, role[lower] >= 0 ? role[lower] : role[upper]));
    }

    void find_leg(int side, Role upper) {
        const Role lower = static_cast<Role>(static_cast<int>(upper) + 1);
        const Role foot = static_cast<Role>(static_cast<int>(upper) + 2);
        set(upper, find(upper_leg_words, side));
        set(lower, find(lower_leg_words, side, role[upper]));
        set(upper, find({"hip"}, side, -1, role[lower]));
        set(upper, find({"leg"}, side, -1, role[lower]));
        set(lower, find({"leg"}, side, role[upper]));
        if (role[upper] >= 0) set(foot, find(foot_words, side, role[lower] >= 0 ? role[lower] : role[upper]));
    }

    int first_known(Role a, Role b) const { return role[a] >= 0 ? role[a] : role[b]; }

    void find_trunk() {
        const int left_leg = role[Role::left_upper_leg], right_leg = role[Role::right_upper_leg];
        const int hips = common_ancestor(left_leg, right_leg);
        const int named = find(pelvis_words, 0);
        set(Role::pelvis, named >= 0 && (hips < 0 || descends(hips, named)) ? named : hips);
        const int carries_arms = common_ancestor(first_known(Role::left_clavicle, Role::left_upper_arm),
                                                 first_known(Role::right_clavicle, Role::right_upper_arm));
        const int pelvis = role[Role::pelvis];
        // Where the arms hang on the pelvis itself, or on something above it, there is no chest joint.
        if (carries_arms >= 0 && carries_arms != pelvis && !(pelvis >= 0 && descends(pelvis, carries_arms)))
            set(Role::chest, carries_arms);
        if (carries_arms < 0) set(Role::chest, find({"chest", "upperchest"}, 0));
        const int chest = role[Role::chest];
        if (chest < 0) set(Role::spine, find(spine_words, 0, pelvis));
        const int fork = common_ancestor(pelvis, chest);
        for (int j = chest < 0 ? -1 : joint[chest].parent; j >= 0 && j != fork; j = joint[j].parent)
            if (!name[j].helper && (fork >= 0 || spine_words.count(name[j].word))) lowest_spine = j;
        set(Role::spine, lowest_spine);
    }
    int lowest_spine = -1;

    void find_head() {
        const int chest = role[Role::chest];
        set(Role::head, find({"head"}, 0, role[Role::neck] >= 0 ? role[Role::neck] : chest));
        set(Role::head, find({"head"}, 0));
        set(Role::neck, find({"neck", "necklower"}, 0, chest, role[Role::head]));
        if (chest < 0) return;
        // Rigify counts the neck and head on as spine joints above the chest.
        if (role[Role::head] < 0)
            for (int j = 0; j < static_cast<int>(joint.size()); ++j)
                if (j != chest && descends(j, chest) && name[j].word == "spine") set_last_spine(j);
        for (int j = role[Role::head]; role[Role::neck] < 0 && j >= 0 && j != chest; j = joint[j].parent)
            if (joint[j].parent == chest && j != role[Role::head]) role[Role::neck] = j;
    }
    void set_last_spine(int j) {
        if (role[Role::head] < 0 || descends(j, role[Role::head])) role[Role::head] = j;
    }
};

}  // namespace

RoleMap detect_roles(const std::vector<NamedJoint>& joint, const RoleMap& fixed) {
    RoleSearch search{joint, {}, fixed};
    for (const NamedJoint& each : joint) search.name.push_back(parse(each.name));
    search.find_arm(1, Role::left_clavicle);
    search.find_arm(-1, Role::right_clavicle);
    search.find_leg(1, Role::left_upper_leg);
    search.find_leg(-1, Role::right_upper_leg);
    search.find_trunk();
    search.find_head();
    return search.role;
}

}  // namespace toile::skin
