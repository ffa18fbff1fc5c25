#pragma once

#include <string>

namespace toile::files {

/// The text of a BVH file that is safe to hand to assimp, and what the text announces.
///
/// assimp 5.2.5 composes the channels of a BVH rightly, but trusts the text: it reserves memory for any number of
/// frames and channels, recurses as deep as braces go, keeps a dangling reference where CHANNELS follow a child, leaks
/// the nodes of a hierarchy it gives up on, fails at a space in a joint's name, and ignores values beyond the last
/// frame. So the grammar is checked first; numbers are assimp's to convert.
struct BvhText {
    std::string text;
    int joint_count = 0;
    int channel_count = 0;
    int frame_count = 0;
    double frame_time = 0;  ///< [s]
};

/// Reads and checks; spaces in joint names become underscores. Throws Error with file and line.
BvhText read_bvh_text(const std::string& path);

}  // namespace toile::files
