#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "files/metric_file.h"

namespace toile::evaluate {

/// A folder as evaluations leave it, of its own for each test, and removed after it.
class EvaluatedFolder {
  public:
    EvaluatedFolder();
    ~EvaluatedFolder();
    EvaluatedFolder(const EvaluatedFolder&) = delete;
    EvaluatedFolder& operator=(const EvaluatedFolder&) = delete;

    const std::string& path() const { return path_; }
    std::string file(const std::string& name) const { return path_ + "/" + name; }
    std::string text(const std::string& name) const;  ///< of a file

    /// One predictor, "ridge", on test; the inextensibility prior makes it better, the quasistatic one too little to
    /// tell from noise.
    files::MetricFile accuracy;
    nlohmann::ordered_json accuracy_own;
    files::MetricFile runtime, stability;

    void write();         ///< accuracy.json, runtime.json, stability.json
    void write_arrays();  ///< accuracy.h5: two samples with bodies and images, of four vertices

  private:
    std::string path_;
};

/// A metric of that direction with an interval of +- `half`.
files::Metric metric_of(const std::string& name, double value, double half, const std::string& unit,
                        files::MetricDirection direction = files::MetricDirection::lower);

}  // namespace toile::evaluate
