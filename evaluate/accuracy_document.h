#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "evaluate/quantity.h"
#include "files/metric_file.h"

namespace toile::evaluate {

/// An accuracy.json, read back.
struct AccuracyDocument {
    struct Method {
        std::string name, title;
        double setting = 0;  ///< limit or μ
    };
    struct Predictor {
        std::string name;
        std::vector<Method> method;  ///< the first is the prediction as it is
        std::string mu_sentence;     ///< what came of learning μ; may be empty
    };
    struct Split {
        std::string name;
        int samples = 0, accepted = 0, judged = 0;
    };
    struct Verdict {
        double difference = 0, low = 0, high = 0;
        std::string judgement;
    };
    using VerdictKey = std::tuple<std::string, std::string, std::string, std::string>;  ///< predictor, split, method,
                                                                                        ///< quantity

    std::string dataset, command;
    int vertices = 0;
    double overstretched_limit = 0;
    std::vector<Predictor> predictor;
    std::vector<Split> split;
    std::vector<std::string> remark;
    size_t failures = 0;
    bool has_floor = false;
    std::map<std::string, files::Metric> metric;
    std::map<VerdictKey, Verdict> verdict;

    /// Null where there is no such figure.
    const files::Metric* find(const std::string& predictor_name, const std::string& split_name,
                              const std::string& method, Quantity quantity) const;
    const Verdict* verdict_on(const std::string& predictor_name, const std::string& split_name,
                              const std::string& method, Quantity quantity) const;
};

/// Throws Error, naming file and key, for a file that is missing, damaged or of another version.
AccuracyDocument read_accuracy_document(const std::string& path);

}  // namespace toile::evaluate
