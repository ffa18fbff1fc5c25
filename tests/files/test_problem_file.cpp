#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>

#include "cloth/error.h"
#include "files/problem_file.h"

namespace toile::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ProblemFileTest : public testing::Test {
  protected:
    void SetUp() override {
        path_ =
            (std::filesystem::temp_directory_path() / ("toile_problem_" + std::to_string(getpid()) + ".h5")).string();
    }
    void TearDown() override { std::filesystem::remove(path_); }

    /// A problem of one triangle and two samples, as numpy would write it, after `change` was made to it.
    ProblemFile problem(const std::function<void(Hdf5File&)>& change = {}) const {
        Hdf5File file = Hdf5File::create(path_);
        file.write("/mesh/triangle", std::vector<int64_t>{0, 1, 2}, {1, 3});
        file.write("/mesh/rest_position", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 0.5f, 0}, {3, 3});
        file.write("/samples/predicted", numbers(18), {2, 3, 3});
        if (change) change(file);
        file.close();
        return ProblemFile(path_);
    }
    static std::vector<double> numbers(int count) {
        std::vector<double> value;
        for (int i = 0; i < count; ++i) value.push_back(0.25 * i);
        return value;
    }
    /// "what (dataset)" of the refusal of a problem that was changed.
    std::string refusal(const std::function<void(Hdf5File&)>& change) const {
        try {
            problem(change);
        } catch (const Error& error) {
            EXPECT_EQ(error.where().rfind(path_, 0), 0u) << error.where();
            return error.what() + (" (" + error.where().substr(path_.size()) + ")");
        }
        return {};
    }

    std::string path_;
};

TEST_F(ProblemFileTest, reads_the_smallest_problem) {
    const ProblemFile file = problem();
    EXPECT_EQ(file.sample_count(), 2);
    EXPECT_FALSE(file.has_target());
    EXPECT_EQ(file.mesh().triangle, (Triangles(1, 3) << 0, 1, 2).finished());
    EXPECT_EQ(file.mesh().rest_position(2, 1), 0.5);
    EXPECT_EQ(file.mesh().pattern_position.rows(), 0);
    EXPECT_EQ(file.mesh().mass.size(), 0);
}

TEST_F(ProblemFileTest, reads_samples_a_few_at_a_time) {
    const ProblemFile file = problem();
    EXPECT_THAT(file.predicted(1, 1), ElementsAre(2.25, 2.5, 2.75, 3, 3.25, 3.5, 3.75, 4, 4.25));
    EXPECT_EQ(file.predicted(0, 2), numbers(18));
    EXPECT_THROW(file.predicted(1, 2), Error);
}

TEST_F(ProblemFileTest, reads_what_is_optional) {
    const ProblemFile file = problem([](Hdf5File& f) {
        f.write("/mesh/pattern_position", std::vector<float>{0, 0, 1, 0, 0, 0.5f, 7, 7}, {4, 2});
        f.write("/mesh/pattern_triangle", std::vector<int16_t>{0, 1, 2}, {1, 3});
        f.write("/mesh/mass", std::vector<int32_t>{1, 2, 3}, {3});
        f.write("/samples/target", std::vector<float>(18, 0.5f), {2, 3, 3});
    });
    EXPECT_TRUE(file.has_target());
    EXPECT_EQ(file.target(1, 1), std::vector<double>(9, 0.5));
    EXPECT_EQ(file.mesh().pattern_position.rows(), 4);
    EXPECT_EQ(file.mesh().pattern_triangle(0, 2), 2);
    EXPECT_EQ(file.mesh().mass, Eigen::Vector3d(1, 2, 3));
}

TEST_F(ProblemFileTest, whole_numbers_are_positions_too) {
    const ProblemFile file = problem([](Hdf5File& f) {
        f.remove("/samples/predicted");
        f.write("/samples/predicted", std::vector<int64_t>(9, -4), {1, 3, 3});
    });
    EXPECT_EQ(file.predicted(0, 1), std::vector<double>(9, -4.0));
}

TEST_F(ProblemFileTest, a_problem_may_have_no_samples) {
    const ProblemFile file = problem([](Hdf5File& f) {
        f.remove("/samples/predicted");
        f.write("/samples/predicted", std::vector<double>{}, {0, 3, 3});
    });
    EXPECT_EQ(file.sample_count(), 0);
}

TEST_F(ProblemFileTest, refuses_what_is_missing) {
    for (const char* name : {"/mesh/triangle", "/mesh/rest_position", "/samples/predicted"})
        EXPECT_EQ(refusal([&](Hdf5File& f) { f.remove(name); }), "no such dataset (:" + std::string(name) + ")");
    EXPECT_EQ(refusal([](Hdf5File& f) {
                  f.write("/mesh/pattern_position", std::vector<float>(6), {3, 2});
              }),
              "no such dataset (:/mesh/pattern_triangle)");
    EXPECT_EQ(refusal([](Hdf5File& f) {
                  f.write("/mesh/pattern_triangle", std::vector<int>(3), {1, 3});
              }),
              "no such dataset (:/mesh/pattern_position)");
}

TEST_F(ProblemFileTest, refuses_other_shapes) {
    auto with = [&](const char* name, const Shape& shape) {
        return refusal([&](Hdf5File& f) {
            if (f.has(name)) f.remove(name);
            int64_t count = 1;
            for (const int64_t size : shape) count *= size;
            if (std::string(name).find("triangle") != std::string::npos)
                f.write(name, std::vector<int>(static_cast<size_t>(count)), shape);
            else
                f.write(name, std::vector<double>(static_cast<size_t>(count)), shape);
        });
    };
    EXPECT_THAT(with("/samples/predicted", {2, 9}), HasSubstr("has shape (2, 9), not (*, 3, 3) (:/samples/predicted)"));
    EXPECT_THAT(with("/samples/predicted", {2, 4, 3}), HasSubstr("has shape (2, 4, 3), not (*, 3, 3)"));
    EXPECT_THAT(with("/samples/predicted", {2, 3, 2}), HasSubstr("has shape (2, 3, 2), not (*, 3, 3)"));
    EXPECT_THAT(with("/samples/target", {1, 3, 3}), HasSubstr("has shape (1, 3, 3), not (2, 3, 3) (:/samples/target)"));
    EXPECT_THAT(with("/mesh/triangle", {3}), HasSubstr("has shape (3), not (*, 3) (:/mesh/triangle)"));
    EXPECT_THAT(with("/mesh/rest_position", {3, 2}), HasSubstr("(:/mesh/rest_position)"));
    EXPECT_THAT(with("/mesh/mass", {4}), HasSubstr("has shape (4), not (3) (:/mesh/mass)"));
}

TEST_F(ProblemFileTest, refuses_other_types) {
    EXPECT_THAT(refusal([](Hdf5File& f) {
                    f.remove("/mesh/triangle");
                    f.write("/mesh/triangle", std::vector<double>{0, 1, 2}, {1, 3});
                }),
                HasSubstr("holds float64 where integers are expected (:/mesh/triangle)"));
    EXPECT_THAT(refusal([](Hdf5File& f) {
                    f.remove("/samples/predicted");
                    f.write_strings("/samples/predicted", {"a", "b"});
                }),
                HasSubstr("(:/samples/predicted)"));
    EXPECT_THAT(refusal([](Hdf5File& f) {
                    f.remove("/mesh/triangle");
                    f.write("/mesh/triangle", std::vector<int64_t>{0, 1, int64_t{1} << 40}, {1, 3});
                }),
                HasSubstr("out of range (:/mesh/triangle)"));
}

TEST_F(ProblemFileTest, refuses_what_is_no_file) {
    EXPECT_THROW(ProblemFile(path_ + ".absent"), Error);
    EXPECT_THROW(ProblemFile("/"), Error);
}

}  // namespace
}  // namespace toile::files
