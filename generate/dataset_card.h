#pragma once

#include <string>
#include <vector>

namespace toile::generate {

struct CardOptions {
    std::string command;               ///< that made the data set, as it was typed; left out where empty
    std::vector<std::string> remarks;  ///< what was mended or estimated on the way, one sentence each
};

/// Writes CARD.md beside a data set, and samples.png, which it shows: counts by split, failures by reason with their
/// pose numbers, distributions of every column of the certificate over the accepted samples, times, disk, images,
/// units, materials, licences, the resolved configuration, program version and digests, as far as the data set has
/// them. Reads the columns, and of the large arrays the samples shown alone. What it says depends on the data set and
/// the options, not on the clock; only drape times were measured by one.
///
/// Returns the paths written. Throws Error where the data set cannot be read or the files not be written.
std::vector<std::string> write_card(const std::string& dataset, const CardOptions& options = {});

/// The samples a card shows, of the accepted ones: of each split the first and one from the middle, the worst by
/// stretch and by penetration, and others to make eight. Slots, in order.
std::vector<int> card_slots(const std::vector<int>& split, const std::vector<int>& status,
                            const std::vector<double>& max_stretch, const std::vector<double>& body_penetration);

/// XXH3-128 of all samples' digests in the order of their ids: one value for the whole data set, however it is divided
/// into files.
std::string corpus_digest(const std::string& dataset);

}  // namespace toile::generate
