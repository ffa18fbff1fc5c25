#pragma once

#include <string>
#include <vector>

#include "evaluate/noise.h"
#include "files/noise_file.h"

namespace toile::evaluate {

/// Gathers samples and makes statistics of them.
class NoiseResults {
  public:
    explicit NoiseResults(const std::vector<files::NoiseVariant>& variant);

    /// `seconds`: of the configured drape, then of each variant's.
    void add(const files::NoiseRecord& record, const std::vector<double>& seconds);
    /// Fills in what is said of variants, spread and configured drapes.
    void summarise(NoiseSummary& summary) const;
    /// Writes `summary.results`: metrics, the statistics, how the distances are spread, and of each sample id,
    /// statuses, root mean square and largest spread.
    void write(const NoiseSummary& summary, const files::NoiseHeader& header,
               const generate::SceneConfig& config) const;

  private:
    struct Pairs {
        std::string name;
        std::vector<double> distance;  ///< of all vertices of the samples that count [m]
        int samples = 0, accepted = 0;
        double seconds = 0;

        NoiseStatistics statistics(int drapes) const;
    };
    struct Sample {
        std::int64_t id;
        int status;
        std::vector<int> variant_status;
        double rms, largest;
    };
    Pairs configured_, spread_;
    std::vector<Pairs> variant_;
    std::vector<Sample> sample_;
};

/// The noise floor as a table of text, in millimetres.
std::string noise_table(const NoiseSummary& summary);

}  // namespace toile::evaluate
