#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "cloth/error.h"
#include "files/config_file.h"
#include "files/digest.h"

namespace toile::files {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

enum class Method { linear, dual };

/// What the tests bind: one field of each kind.
struct Options {
    double height = 1.75;
    std::optional<double> scale;
    int count = 12;
    std::optional<int> size;
    std::uint64_t seed = 7;
    bool quiet = false;
    std::string name = "scene";
    Method method = Method::linear;
    ConfigPath file;
    Eigen::Vector3d up = {0, 1, 0};
    double lower = -1, upper = 1;
    std::vector<int> pinned;
    std::vector<std::string> words = {"a"};
    std::vector<double> shares = {0.5};
    std::vector<std::string> tools = {"needle"};
    bool has_image = false;
};

Options bind(const ConfigFile& config) {
    Options o;
    ConfigTable root = config.root();
    if (auto body = root.table("body", "the body")) {
        body->real("height", o.height, {.lower = 1.2, .upper = 2.2, .unit = "m", .doc = "how tall"});
        body->real("scale", o.scale, {.lower = 0, .above = true, .doc = "estimated where it is not given"});
        body->integer("count", o.count, {.lower = 1, .upper = 100});
        body->integer_or("size", o.size, "auto", {.lower = 8, .upper = 4096});
        body->seed("seed", o.seed, "the seed");
        body->boolean("quiet", o.quiet, "says nothing");
        body->text("name", o.name, "a name");
        body->choice<Method>("method", o.method, {{"linear", Method::linear}, {"dual", Method::dual}}, "how");
        body->path("file", o.file, "a file");
        body->vector("up", o.up, {});
        body->interval("limits", o.lower, o.upper, {.lower = -3.2, .upper = 3.2, .unit = "rad"});
        body->integers("pinned", o.pinned, {.lower = 0});
        body->texts("words", o.words, "words");
        body->reals("shares", o.shares, {.lower = 0, .upper = 1});
        body->choices("tools", o.tools, {"needle", "thread", "shears"}, "of a tailor");
    }
    o.has_image = root.table("image", "the image").has_value();
    config.refuse_unknown_keys();
    return o;
}

class ConfigFileTest : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("toile_config_" + std::to_string(::getpid()) + "_" +
                                               ::testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string path(const std::string& name = "scene.toml") const { return (folder_ / name).string(); }
    void write(const std::string& text, const std::string& name = "scene.toml") const {
        std::ofstream(path(name), std::ios::binary) << text;
    }
    Options read(const std::string& text, const std::vector<std::string>& overrides = {}) const {
        write(text);
        return bind(ConfigFile(path(), overrides));
    }
    /// The error of reading `text`, as "what (where) mend".
    std::string error(const std::string& text, const std::vector<std::string>& overrides = {}) const {
        try {
            read(text, overrides);
        } catch (const Error& e) {
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << "an error is one line";
            return std::string(e.what()) + " (" + e.where() + ") " + e.mend();
        }
        return "no error";
    }

    fs::path folder_;
};

TEST_F(ConfigFileTest, KeepsTheDefaultsOfTheStruct) {
    const Options o = read("[body]\n");
    EXPECT_EQ(o.height, 1.75);
    EXPECT_FALSE(o.scale);
    EXPECT_EQ(o.count, 12);
    EXPECT_EQ(o.name, "scene");
    EXPECT_FALSE(o.has_image);
}

TEST_F(ConfigFileTest, ReadsEveryKindOfField) {
    write("", "mesh.obj");
    const Options o = read(
        "[body]\nheight = 2\nscale = 0.5\ncount = 3\nsize = 64\nseed = 99\nquiet = true\nname = \"x\"\nmethod = "
        "\"dual\"\n"
        "file = \"mesh.obj\"\nup = [0, 0, 1.5]\nlimits = [-0.5, 0.25]\npinned = [4, 5]\nwords = [\"b\", "
        "\"c\"]\nshares = [0, 0.25, 1e-3]\ntools = [\"shears\", \"thread\"]\n[image]\n");
    EXPECT_EQ(o.height, 2.0);
    EXPECT_EQ(o.scale, 0.5);
    EXPECT_EQ(o.count, 3);
    EXPECT_EQ(o.size, 64);
    EXPECT_EQ(o.seed, 99u);
    EXPECT_TRUE(o.quiet);
    EXPECT_EQ(o.name, "x");
    EXPECT_EQ(o.method, Method::dual);
    EXPECT_EQ(o.file.written, "mesh.obj");
    EXPECT_EQ(o.file.resolved, path("mesh.obj"));
    EXPECT_EQ(o.up, Eigen::Vector3d(0, 0, 1.5));
    EXPECT_EQ(o.lower, -0.5);
    EXPECT_EQ(o.upper, 0.25);
    EXPECT_EQ(o.pinned, (std::vector<int>{4, 5}));
    EXPECT_EQ(o.words, (std::vector<std::string>{"b", "c"}));
    EXPECT_EQ(o.shares, (std::vector<double>{0, 0.25, 1e-3}));
    EXPECT_EQ(o.tools, (std::vector<std::string>{"shears", "thread"}));
    EXPECT_TRUE(o.has_image);
}

TEST_F(ConfigFileTest, NamesAnUnknownKeyAndTheNearestKnownOne) {
    const std::string text = error("[body]\nheight = 1.8\nhieght = 1.7\n");
    EXPECT_THAT(text, HasSubstr("unknown key body.hieght"));
    EXPECT_THAT(text, HasSubstr("scene.toml:3)"));
    EXPECT_THAT(text, HasSubstr("did you mean height?"));
    EXPECT_THAT(error("[bdy]\nheight = 1.8\n"), HasSubstr("unknown table [bdy]"));
    EXPECT_THAT(error("hello = 1\n"), HasSubstr("unknown key hello"));
    EXPECT_THAT(error("[body.up]\nx = 1\n"), HasSubstr("body.up is a table"));
}

TEST_F(ConfigFileTest, NamesValueAndBoundsOfWhatIsOutOfRange) {
    const std::string text = error("[body]\nheight = 5.0\n");
    EXPECT_THAT(text, HasSubstr("body.height is 5.0"));
    EXPECT_THAT(text, HasSubstr("1.2 to 2.2 [m]"));
    EXPECT_THAT(text, HasSubstr("scene.toml:2)"));
    for (const char* line : {"height = nan", "height = inf", "height = -inf", "height = 1e300", "scale = 0",
                             "scale = -1", "count = 0", "count = 101", "count = 99999999999", "size = 4", "seed = -1",
                             "limits = [1, -1]", "limits = [-9, 0]", "pinned = [-1]", "pinned = [1, 3000000000]",
                             "up = [0, nan, 1]", "shares = [0.5, 1.5]", "shares = [nan]", "tools = [\"thimble\"]"})
        EXPECT_THAT(error(std::string("[body]\n") + line + "\n"), HasSubstr("scene.toml:2)")) << line;
}

TEST_F(ConfigFileTest, RefusesWrongTypes) {
    for (const char* line :
         {"height = \"tall\"",    "height = true",      "height = [1]",     "count = 1.5",        "count = \"3\"",
          "size = \"automatic\"", "seed = 1.0",         "quiet = 1",        "name = 3",           "method = \"quick\"",
          "method = 1",           "file = 1",           "file = \"\"",      "up = [0, 1]",        "up = 1",
          "limits = 1",           "limits = [0, 1, 2]", "pinned = 1",       "pinned = [1.5]",     "words = [1]",
          "words = \"a\"",        "shares = 0.5",       "shares = [\"a\"]", "tools = \"needle\"", "tools = [1]"})
        EXPECT_THAT(error(std::string("[body]\n") + line + "\n"), HasSubstr("scene.toml:2)")) << line;
    EXPECT_THAT(error("body = 3\n"), HasSubstr("body is 3, a table is expected"));
    EXPECT_THAT(error("[[body]]\nheight = 1.8\n"), HasSubstr("a table is expected"));
    EXPECT_THAT(error("[body]\nmethod = \"quick\"\n"), HasSubstr("linear, dual"));
}

TEST_F(ConfigFileTest, RefusesFilesThatAreNotConfigurations) {
    EXPECT_THROW(ConfigFile(path("absent.toml"), {}), Error);
    EXPECT_THROW(ConfigFile(folder_.string(), {}), Error);
    EXPECT_THAT(error(""), HasSubstr("empty"));
    EXPECT_THAT(error("# only a comment\n"), HasSubstr("empty"));
    EXPECT_THAT(error("[body\nheight = 1"), HasSubstr("scene.toml:1)"));
    EXPECT_THAT(error("[body]\nheight ="), HasSubstr("not valid TOML"));
    EXPECT_THAT(error("[body]\nheight = 1.5\nheight = 1.6\n"), HasSubstr("scene.toml:3)"));
    EXPECT_THAT(error(std::string("\x89HDF\r\n\x1a\n\0\0\xff\xfe", 13)), HasSubstr("not valid TOML"));
    EXPECT_THAT(error(std::string(5 << 20, 'a')), HasSubstr("larger than 4 MB"));
    EXPECT_THAT(error(std::string(20000, '[')), HasSubstr("not valid TOML"));
    std::string nested = "a";
    for (int level = 0; level < 1'000'000; ++level) nested += ".a";
    EXPECT_THAT(error(nested + " = 1\n"), HasSubstr("dots: not a configuration"));
    EXPECT_THAT(error("[body]\n", {nested + "=1"}), HasSubstr("more parts than any that is known"));
}

TEST_F(ConfigFileTest, TakesLettersWithAccentsInTextsAlone) {
    EXPECT_EQ(read("# \u00e9t\u00e9\n[body]\nname = \"\u00e9t\u00e9 \\\"\u00e9\"  # \u00e9\n").name,
              "\u00e9t\u00e9 \"\u00e9");
    EXPECT_EQ(read("[body]\nname = '\u00e9t\u00e9'\n").name, "\u00e9t\u00e9");
    EXPECT_EQ(read("[body]\nname = \"\"\"\u00e9\"t\"\\\n  \\\"\u00e9\"\"\"\n").name, "\u00e9\"t\"\"\u00e9");
    EXPECT_EQ(read("[body]\n", {"body.name=\u00e9t\u00e9"}).name, "\u00e9t\u00e9");
    for (const char* text :
         {"\u00e9 = 1\n", "[body]\nheight = 1\u00e9\n", "[body\u00e9]\n", "[body]\nheight = 20\"0\u03e4\"\n",
          "[body]\nname = \"\"\"a\\\u00e9\"\"\"\n", "[body]\nname = \"\"\"a\\\n \u00e9\"\"\"\n"})
        EXPECT_THAT(error(text), HasSubstr("not ASCII (")) << text;
}

TEST_F(ConfigFileTest, RefusesPathsThatLeadNowhere) {
    EXPECT_THAT(error("[body]\nfile = \"absent.obj\"\n"), HasSubstr("not there"));
    EXPECT_THAT(error("[body]\nfile = \".\"\n"), HasSubstr("is not a file"));
}

TEST_F(ConfigFileTest, LaysOverridesOverTheFile) {
    EXPECT_EQ(read("[body]\nheight = 1.5\n", {"body.height=1.9"}).height, 1.9);
    EXPECT_EQ(read("[body]\n", {"body.method=dual"}).method, Method::dual);
    EXPECT_EQ(read("[body]\n", {"body.name=two words"}).name, "two words");
    EXPECT_EQ(read("[body]\n", {"body.limits=[-0.5, 0.5]"}).upper, 0.5);
    EXPECT_TRUE(read("[body]\n", {"image={}"}).has_image);
    EXPECT_EQ(read("[body]\n", {"body.count=3", "body.count=4"}).count, 4);
}

TEST_F(ConfigFileTest, OverridesAloneMakeAConfiguration) {
    const ConfigFile config({"body.height=1.5", "body.name=alone"});
    const Options o = bind(config);
    EXPECT_EQ(o.height, 1.5);
    EXPECT_EQ(o.name, "alone");
    EXPECT_EQ(o.count, 12);
    EXPECT_THAT(config.resolved(ConfigFile::Paths::written), HasSubstr("height = 1.5"));
    try {
        bind(ConfigFile({"body.hight=1.5"}));
        ADD_FAILURE() << "an unknown key was read";
    } catch (const Error& error) {
        EXPECT_EQ(error.where(), "--set body.hight");
    }
}

TEST_F(ConfigFileTest, RefusesBadOverrides) {
    EXPECT_THAT(error("[body]\n", {"body.height=9"}), HasSubstr("(--set body.height)"));
    EXPECT_THAT(error("[body]\n", {"body.hieght=1.8"}), HasSubstr("unknown key body.hieght (--set body.hieght)"));
    EXPECT_THAT(error("[body]\nheight = 1.5\n", {"body.height.x=1"}), HasSubstr("body.height is not a table"));
    for (const char* text : {"", "=", "height", ".a=1", "a.=1", "a..b=1"})
        EXPECT_THAT(error("[body]\n", {text}), HasSubstr("is not key=value")) << text;
    EXPECT_THAT(error("[body]\n", {"body.count=1\nevil = 2"}), HasSubstr("body.count is"));
}

TEST_F(ConfigFileTest, PrintsWhatItReadsBackUnchanged) {
    write("", "mesh.obj");
    write("[body]\nheight = 1.6180339887498949\nfile = \"mesh.obj\"\nname = \"a \\\"b\\\" \\u0007\"\nsize = 32\n");
    const ConfigFile first(path(), {});
    bind(first);
    const std::string text = first.resolved(ConfigFile::Paths::absolute);
    EXPECT_THAT(text, HasSubstr("1.2 to 2.2 [m]; how tall"));
    EXPECT_THAT(text, HasSubstr(path("mesh.obj")));
    EXPECT_THAT(text, HasSubstr("# scale: not given"));
    EXPECT_THAT(first.resolved(ConfigFile::Paths::written), HasSubstr("file = \"mesh.obj\""));

    write(text, "again.toml");
    const ConfigFile second(path("again.toml"), {});
    const Options o = bind(second);
    EXPECT_EQ(o.height, 1.6180339887498949);
    EXPECT_EQ(o.name, "a \"b\" \a");
    EXPECT_EQ(second.resolved(ConfigFile::Paths::absolute), text);
    EXPECT_EQ(second.hash(), first.hash()) << "the hash follows the file's contents, not its place";
}

TEST_F(ConfigFileTest, HashFollowsValuesAndContents) {
    const auto hash = [&](const std::string& text) {
        write(text);
        const ConfigFile config(path(), {});
        bind(config);
        return config.hash();
    };
    write("one", "mesh.obj");
    const std::string plain = hash("[body]\nfile = \"mesh.obj\"\n");
    EXPECT_EQ(plain.size(), 32u);
    EXPECT_EQ(plain, hash("# a comment\n[body]\nheight = 1.75\nfile = \"mesh.obj\"\n"))
        << "a default written out is the default";
    EXPECT_NE(plain, hash("[body]\nheight = 1.76\nfile = \"mesh.obj\"\n"));
    write("two", "mesh.obj");
    EXPECT_NE(plain, hash("[body]\nfile = \"mesh.obj\"\n"));
}

TEST(Digest, KnowsPublishedValue) {
    // the XXH3-128 of empty input, as published with xxHash
    EXPECT_EQ(text_digest(""), "99aa06d3014798d86001c324468d497f");
    EXPECT_FALSE(file_digest("/nonexistent"));
}

}  // namespace
}  // namespace toile::files
