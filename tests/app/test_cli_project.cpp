#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>

#include "files/hdf5_file.h"
#include "tests/app/cli_runner.h"
#include "tests/support/small_problem.h"

namespace toile::app {
namespace {

using files::Hdf5File;
using test::edge_length;
using test::vertices;
using test::width;
using Problem = test::SmallProblem;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

class CliProject : public CliTest {
  protected:
    std::vector<double> values(const std::string& name, const std::string& dataset) const {
        return Hdf5File::open(path(name)).read<double>(dataset).value;
    }
    std::vector<int> statuses(const std::string& name) const {
        return Hdf5File::open(path(name)).read<int>("/samples/status").value;
    }
    /// E = Σ |r* - r_T|² of each sample, from the positions.
    std::vector<double> losses(const std::string& name, const std::vector<double>& target) const {
        const std::vector<double> position = values(name, "/samples/projected");
        std::vector<double> loss(position.size() / width, 0.0);
        for (size_t k = 0; k < position.size(); ++k)
            loss[k / width] += std::pow(position[k] - target[k % target.size()], 2);
        return loss;
    }
    std::string problem_with(const std::function<void(Hdf5File&)>& change) {
        Problem(2).write(path("changed.h5"));
        Hdf5File file = Hdf5File::edit(path("changed.h5"));
        change(file);
        file.close();
        return "changed.h5";
    }
    void check_differences(const std::string& prior, const std::string& keys);
};

const char* const priors[] = {"inextensibility", "quasistatic"};

TEST_F(CliProject, ProjectsAndValidates) {
    Problem(3).write(path("p.h5"));
    for (const std::string prior : priors) {
        const Outcome outcome = run("project " + prior + " p.h5 --out " + prior + ".h5 --gradient");
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr("3 of 3 converged, 20 vertices, 43 edges"));
        EXPECT_THAT(outcome.out, HasSubstr("gradient "));
        EXPECT_THAT(statuses(prior + ".h5"), Each(0));
        EXPECT_THAT(values(prior + ".h5", "/samples/residual"), Each(::testing::Le(1e-6)));
        EXPECT_EQ(run("validate " + prior + ".h5").status, 0);
    }
    EXPECT_EQ(run("validate p.h5").status, 0);
}

TEST_F(CliProject, SaysHowFarItIsOnStderrAlone) {
    Problem(2).write(path("p.h5"));
    const Outcome outcome = run("project inextensibility p.h5 --out o.h5");
    EXPECT_THAT(outcome.err, HasSubstr("projecting 2/2"));
    EXPECT_THAT(outcome.out, Not(HasSubstr("projecting")));
}

TEST_F(CliProject, ExplainsItsKeys) {
    EXPECT_THAT(run("project inextensibility --help").out, HasSubstr("stretch_limit = 0.0"));
    EXPECT_THAT(run("project quasistatic --help").out, HasSubstr("mu = 0.1"));
    EXPECT_THAT(run("project --help").out, HasSubstr("--gradient"));
}

TEST_F(CliProject, KeysReachThePrior) {
    Problem(2).write(path("p.h5"));
    ASSERT_EQ(run("project inextensibility p.h5 --out a.h5").status, 0);
    ASSERT_EQ(run("project inextensibility p.h5 --out b.h5 --set stretch_limit=0.5").status, 0);
    const std::vector<double> a = values("a.h5", "/model/edge_max_length"),
                              b = values("b.h5", "/model/edge_max_length");
    for (size_t e = 0; e < a.size(); ++e) EXPECT_NEAR(b[e], 1.5 * a[e], 1e-15);
    ASSERT_EQ(run("project quasistatic p.h5 --out c.h5 --set mu=0.2").status, 0);
    ASSERT_EQ(run("project quasistatic p.h5 --out d.h5 --set mu=0.4").status, 0);
    const std::vector<double> c = values("c.h5", "/model/target_stiffness"),
                              d = values("d.h5", "/model/target_stiffness");
    for (size_t v = 0; v < c.size(); ++v) EXPECT_NEAR(d[v], 2 * c[v], 1e-12 * d[v]);
    EXPECT_THAT(Hdf5File::open(path("d.h5")).string_attribute("/", "config"), HasSubstr("mu = 0.4"));
}

TEST_F(CliProject, TheOtherMethodsAgree) {
    Problem(2).write(path("p.h5"));
    for (const auto& [prior, method] : {std::pair{"inextensibility", "cone"}, {"quasistatic", "newton_cg"}}) {
        const std::string command = std::string("project ") + prior + " p.h5 --set tolerance=1e-9 --out ";
        ASSERT_EQ(run(command + "a.h5").status, 0);
        ASSERT_EQ(run(command + "b.h5 --set method=" + method).status, 0);
        const std::vector<double> a = values("a.h5", "/samples/projected"), b = values("b.h5", "/samples/projected");
        for (size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-4 * edge_length) << prior << " " << k;
    }
}

TEST_F(CliProject, RefusesBadKeys) {
    Problem(1).write(path("p.h5"));
    for (const auto& [keys, expected] : {std::pair{"stretch=0.1", "unknown key stretch"},
                                         {"mu=0.1", "unknown key mu"},
                                         {"stretch_limit=-1", "stretch_limit is -1"},
                                         {"stretch_limit=tight", "stretch_limit is \"tight\""},
                                         {"tolerance=0", "tolerance is 0"},
                                         {"tolerance=nan", "tolerance is nan"},
                                         {"max_iterations=0", "max_iterations is 0"},
                                         {"max_iterations=1.5", "max_iterations is 1.5"},
                                         {"method=magic", "method is \"magic\""},
                                         {"tolerance", "is not key=value"}}) {
        const std::string command = std::string("project inextensibility p.h5 --out o.h5 --set ") + keys;
        expect_refused(command, expected);
        EXPECT_THAT(run(command).err, HasSubstr("keys: method, stretch_limit, tolerance, max_iterations"));
    }
    for (const auto& [keys, expected] : {std::pair{"stretch_limit=0.1", "unknown key stretch_limit"},
                                         {"mu=0", "mu is 0"},
                                         {"mu=inf", "mu is inf"},
                                         {"stretch_stiffness=-1", "stretch_stiffness is -1"},
                                         {"bending_stiffness=-1", "bending_stiffness is -1"},
                                         {"axial_stiffness=soft", "axial_stiffness is \"soft\""}})
        expect_refused(std::string("project quasistatic p.h5 --out o.h5 --set ") + keys, expected);
}

TEST_F(CliProject, RefusesBadFlags) {
    Problem(1).write(path("p.h5"), false);
    expect_refused("project", "subcommand");
    expect_refused("project magic p.h5 --out o.h5", "");
    expect_refused("project inextensibility --out o.h5", "PROBLEM");
    expect_refused("project inextensibility p.h5", "--out");
    expect_refused("project inextensibility p.h5 --out o.h5 --jobs 0", "--jobs");
    expect_refused("project inextensibility p.h5 --out o.h5 --gradient", "/samples/target");
}

TEST_F(CliProject, RefusesBadProblems) {
    write("empty.h5", "");
    write("garbage.h5", "\x01\x02 garbage");
    const std::string command = "project inextensibility --out o.h5 ";
    for (const char* name : {"absent.h5", "empty.h5", "garbage.h5", "."}) expect_refused(command + name, name);
    auto refuse = [&](const std::string& expected, const std::function<void(Hdf5File&)>& change) {
        expect_refused(command + problem_with(change), expected);
        expect_refused("project quasistatic --out o.h5 changed.h5", expected);
    };
    refuse("changed.h5:/samples/predicted", [](Hdf5File& f) { f.remove("/samples/predicted"); });
    refuse("changed.h5:/mesh/triangle", [](Hdf5File& f) { f.remove("/mesh/triangle"); });
    refuse("has shape (1, 2, 3)", [](Hdf5File& f) {
        f.remove("/samples/predicted");
        f.write("/samples/predicted", std::vector<double>(6), {1, 2, 3});
    });
    refuse("refers to vertex 99", [](Hdf5File& f) {
        f.remove("/mesh/triangle");
        f.write("/mesh/triangle", std::vector<int>{0, 1, 99}, {1, 3});
    });
    refuse("has no length at rest", [](Hdf5File& f) {
        f.remove("/mesh/rest_position");
        f.write("/mesh/rest_position", std::vector<double>(width, 1.0), {vertices, 3});
    });
    refuse("the mass of vertex 0 is negative",
           [](Hdf5File& f) { f.write("/mesh/mass", std::vector<double>(vertices, -1.0), {vertices}); });
}

TEST_F(CliProject, RefusesPlacesItCannotWriteTo) {
    Problem(3).write(path("p.h5"));
    expect_refused("project inextensibility p.h5 --out nowhere/o.h5", "nowhere");
    expect_refused("project inextensibility p.h5 --out .", "folder");
    expect_refused("project inextensibility p.h5 --out ./p.h5", "would replace the problem");
    expect_refused("project inextensibility p.h5 --out o.h5", "o.h5", "ulimit -f 8;");
}

TEST_F(CliProject, ASampleThatIsNotFiniteIsLeftOut) {
    Problem problem(4);
    problem.write(path("sound.h5"));
    problem.predicted[width + 7] = std::numeric_limits<double>::quiet_NaN();
    problem.predicted[2 * width] = -std::numeric_limits<double>::infinity();
    problem.write(path("p.h5"));
    for (const std::string prior : priors) {
        const Outcome outcome = run("project " + prior + " p.h5 --out o.h5 --gradient");
        EXPECT_EQ(outcome.status, 3);
        EXPECT_THAT(outcome.err, HasSubstr("toile: sample 1 was rejected"));
        EXPECT_THAT(outcome.err, HasSubstr("toile: sample 2 was rejected"));
        EXPECT_EQ(statuses("o.h5"), (std::vector<int>{0, 2, 2, 0}));
        ASSERT_EQ(run("project " + prior + " sound.h5 --out s.h5 --gradient").status, 0);
        for (const char* dataset : {"/samples/projected", "/samples/gradient"}) {
            const std::vector<double> found = values("o.h5", dataset), expected = values("s.h5", dataset);
            for (size_t k = 0; k < found.size(); ++k) {
                if (k / width == 1 || k / width == 2)
                    ASSERT_TRUE(std::isnan(found[k])) << dataset << " " << k;
                else
                    ASSERT_EQ(found[k], expected[k]) << dataset << " " << k;
            }
        }
        EXPECT_EQ(run("validate o.h5").status, 0);
    }
    EXPECT_EQ(run("validate p.h5").status, 2);
}

TEST_F(CliProject, ATargetThatIsNotFiniteHasNoGradient) {
    Problem problem(3);
    problem.target[width + 1] = std::numeric_limits<double>::quiet_NaN();
    problem.write(path("p.h5"));
    for (const std::string prior : priors) {
        const Outcome outcome = run("project " + prior + " p.h5 --out o.h5 --gradient");
        EXPECT_EQ(outcome.status, 3);
        EXPECT_THAT(outcome.err, HasSubstr("toile: sample 1 has no gradient"));
        EXPECT_THAT(statuses("o.h5"), Each(0));
        const std::vector<double> gradient = values("o.h5", "/samples/gradient");
        for (size_t k = 0; k < gradient.size(); ++k) ASSERT_EQ(std::isnan(gradient[k]), k / width == 1) << k;
        EXPECT_EQ(run("validate o.h5").status, 0);
    }
}

TEST_F(CliProject, AnAccuracyThatIsNotReachedIsSaid) {
    Problem(2, 0.05).write(path("p.h5"));
    for (const std::string prior : priors) {
        const Outcome outcome =
            run("project " + prior + " p.h5 --out o.h5 --set tolerance=1e-10 --set max_iterations=1");
        EXPECT_EQ(outcome.status, 3);
        EXPECT_THAT(outcome.err, HasSubstr("toile: sample 0 did not reach the accuracy"));
        EXPECT_THAT(statuses("o.h5"), Each(1));
        EXPECT_EQ(run("validate o.h5").status, 0) << "it is honest";
    }
}

TEST_F(CliProject, NeitherJobsNorNeighboursChangeASample) {
    const Problem problem(67);
    problem.write(path("p.h5"));
    Problem turned = problem;  // the last sample comes first
    for (auto* value : {&turned.predicted, &turned.target})
        std::rotate(value->begin(), value->end() - static_cast<std::ptrdiff_t>(width), value->end());
    turned.write(path("turned.h5"));
    for (const std::string prior : priors) {
        ASSERT_EQ(run("project " + prior + " p.h5 --out one.h5 --gradient").status, 0);
        ASSERT_EQ(run("project " + prior + " p.h5 --out two.h5 --gradient --jobs 2").status, 0);
        ASSERT_EQ(run("project " + prior + " turned.h5 --out turned_out.h5 --gradient").status, 0);
        for (const char* dataset : {"/samples/projected", "/samples/gradient"}) {
            const std::vector<double> one = values("one.h5", dataset);
            EXPECT_EQ(one, values("two.h5", dataset));
            std::vector<double> other = values("turned_out.h5", dataset);
            std::rotate(other.begin(), other.begin() + static_cast<std::ptrdiff_t>(width), other.end());
            EXPECT_EQ(one, other);
        }
    }
}

TEST_F(CliProject, BatchesOfAnySizeGiveTheSame) {
    Problem all(65);
    all.write(path("all.h5"));
    ASSERT_EQ(run("project inextensibility all.h5 --out all_out.h5").status, 0);
    const std::vector<double> expected = values("all_out.h5", "/samples/projected");
    all.predicted.resize(2 * width);
    all.write(path("two.h5"), false);
    ASSERT_EQ(run("project inextensibility two.h5 --out two_out.h5").status, 0);
    const std::vector<double> two = values("two_out.h5", "/samples/projected");
    EXPECT_TRUE(std::equal(two.begin(), two.end(), expected.begin()));
    all.predicted.resize(width);
    all.write(path("single.h5"), false);
    ASSERT_EQ(run("project inextensibility single.h5 --out single_out.h5").status, 0);
    const std::vector<double> single = values("single_out.h5", "/samples/projected");
    for (size_t k = 0; k < width; ++k) EXPECT_NEAR(single[k], expected[k], 1e-4 * edge_length);
}

TEST_F(CliProject, NoSamplesAreSoonDone) {
    Problem(0).write(path("p.h5"));
    for (const std::string prior : priors) {
        EXPECT_EQ(run("project " + prior + " p.h5 --out o.h5 --gradient").status, 0);
        EXPECT_EQ(run("validate o.h5").status, 0);
    }
}

/// Moves single numbers of r̂ by +-h, projects again, and compares the losses with the gradient.
void CliProject::check_differences(const std::string& prior, const std::string& keys) {
    Problem problem(1, 0.006);
    problem.write(path("p.h5"));
    const std::string command = "project " + prior + keys + " --set tolerance=1e-10 ";
    ASSERT_EQ(run(command + "p.h5 --out o.h5 --gradient").status, 0);
    const std::vector<double> gradient = values("o.h5", "/samples/gradient");
    EXPECT_NEAR(values("o.h5", "/samples/loss")[0], losses("o.h5", problem.target)[0], 1e-15);

    const double h = 1e-4 * edge_length;
    const size_t places[] = {0, 7, 20, 31, 44, 59};
    Problem moved = problem;
    moved.predicted.clear();
    for (const size_t k : places)
        for (const double sign : {1.0, -1.0}) {
            moved.predicted.insert(moved.predicted.end(), problem.predicted.begin(), problem.predicted.end());
            moved.predicted[moved.predicted.size() - width + k] += sign * h;
        }
    moved.write(path("moved.h5"), false);
    ASSERT_EQ(run(command + "moved.h5 --out moved_out.h5").status, 0);
    const std::vector<double> loss = losses("moved_out.h5", problem.target);
    double largest = 0;
    for (const double one : gradient) largest = std::max(largest, std::abs(one));
    ASSERT_GT(largest, 0);
    for (size_t i = 0; i < std::size(places); ++i) {
        const double difference = (loss[2 * i] - loss[2 * i + 1]) / (2 * h);
        EXPECT_NEAR(gradient[places[i]], difference, 1e-4 * largest) << prior << " at " << places[i];
    }
}

TEST_F(CliProject, GradientsMatchDifferencesOfTheCommandItself) {
    check_differences("inextensibility", "");
    check_differences("inextensibility", " --set stretch_limit=0.05");
    check_differences("quasistatic", "");
}

TEST_F(CliProject, TheGradientByMuMatchesDifferencesOfTheCommandItself) {
    const Problem problem(1, 0.006);
    problem.write(path("p.h5"));
    const std::string command = "project quasistatic p.h5 --set tolerance=1e-11 ";
    ASSERT_EQ(run(command + "--out o.h5 --gradient").status, 0);
    ASSERT_EQ(run(command + "--out more.h5 --set mu=0.1001").status, 0);
    ASSERT_EQ(run(command + "--out less.h5 --set mu=0.0999").status, 0);
    const double more = losses("more.h5", problem.target)[0], less = losses("less.h5", problem.target)[0];
    const double gradient = values("o.h5", "/samples/gradient_mu")[0];
    EXPECT_NEAR(gradient, (more - less) / 2e-4, 1e-4 * std::abs(gradient));
    double sum = 0;
    for (const double one : values("o.h5", "/samples/gradient_mu_vertex")) sum += one;
    EXPECT_NEAR(sum, gradient, 1e-9 * std::abs(gradient));
}

TEST_F(CliProject, ValidateFindsWhatIsWrong) {
    Problem(2).write(path("p.h5"));
    ASSERT_EQ(run("project inextensibility p.h5 --out sound.h5").status, 0);
    auto refuse = [&](const std::string& expected, const std::string& dataset, const auto& change) {
        std::filesystem::copy_file(path("sound.h5"), path("o.h5"), std::filesystem::copy_options::overwrite_existing);
        Hdf5File file = Hdf5File::edit(path("o.h5"));
        auto array = file.read<double>(dataset);
        change(array.value);
        file.remove(dataset);
        file.write(dataset, array.value, array.shape);
        file.close();
        const Outcome outcome = run("validate o.h5");
        EXPECT_EQ(outcome.status, 2);
        EXPECT_THAT(outcome.out, HasSubstr(expected));
    };
    using Values = std::vector<double>;
    refuse("/samples/multiplier[1]: edge 0 has -1", "/samples/multiplier", [](Values& v) { v[43] = -1; });
    refuse("times as long as it may be", "/samples/projected", [](Values& v) { v[0] -= 0.01; });
    refuse("/samples/residual[0]: is", "/samples/predicted", [](Values& v) { v[5] += 0.01; });
    refuse("/samples/residual[0]: is stored as 5", "/samples/residual", [](Values& v) { v[0] = 5e-7; });
    refuse("/samples/projected[1]: is not finite", "/samples/projected",
           [](Values& v) { v[width] = std::numeric_limits<double>::quiet_NaN(); });
    refuse("/model/edge_max_length", "/model/edge_max_length", [](Values& v) { v[3] *= 1.01; });
    refuse("/model/target_stiffness", "/model/target_stiffness", [](Values& v) { v[3] = 0; });
    Hdf5File::edit(path("o.h5")).remove("/samples/status");
    EXPECT_THAT(run("validate o.h5").out, HasSubstr("/samples/status: missing"));
}

}  // namespace
}  // namespace toile::app
