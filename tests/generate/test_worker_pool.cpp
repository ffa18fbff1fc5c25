#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <set>
#include <thread>

#include "cloth/error.h"
#include "generate/ordered_work.h"
#include "generate/worker_pool.h"

namespace toile::generate {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

#if defined(__SANITIZE_ADDRESS__)
constexpr bool sanitized = true;  // the sanitizer reports a bad access and exits, and aborts on a failed allocation
#else
constexpr bool sanitized = false;
#endif

std::vector<int> first(int count) {
    std::vector<int> index(static_cast<size_t>(count));
    std::iota(index.begin(), index.end(), 0);
    return index;
}

std::string bytes_of(int index) {
    return "sample " + std::to_string(index) + std::string(static_cast<size_t>(index % 7) * 1000, 'x');
}

/// A folder for what processes tell each other, removed afterwards. No worker is left when a test ends.
class WorkerPool : public ::testing::Test {
  protected:
    void SetUp() override {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::temp_directory_path() / ("toile_pool_" + std::to_string(::getpid()) + "_" + info->name());
        fs::create_directories(folder_);
    }
    void TearDown() override {
        EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a worker is left";
        EXPECT_EQ(errno, ECHILD);
        fs::remove_all(folder_);
    }

    /// How often this was called with the same name, over all processes.
    int count(const std::string& name) const {
        const std::string file = (folder_ / name).string();
        const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
        EXPECT_EQ(::write(descriptor, "x", 1), 1);
        ::close(descriptor);
        return static_cast<int>(fs::file_size(file));
    }

    std::map<int, WorkResult> run(const std::vector<int>& index, const MakeBytes& make) const {
        std::map<int, WorkResult> taken;
        run_in_workers(
            index, options_, [&] { return make; },
            [&](WorkResult result) {
                const int of = result.index;
                EXPECT_TRUE(taken.emplace(of, std::move(result)).second) << "index " << of << " came twice";
            });
        return taken;
    }

    /// All were made, but for `failed`.
    static void expect_made(const std::map<int, WorkResult>& taken, int count, const std::set<int>& failed = {}) {
        ASSERT_EQ(taken.size(), static_cast<size_t>(count));
        for (const auto& [index, result] : taken) {
            EXPECT_EQ(result.failure.has_value(), failed.count(index) == 1) << index << ": " << result.detail;
            if (result.failure)
                EXPECT_TRUE(result.bytes.empty());
            else
                EXPECT_EQ(result.bytes, bytes_of(index));
        }
    }

    fs::path folder_;
    WorkerPoolOptions options_;
};

TEST_F(WorkerPool, MakesEachIndexOnceWhateverTheWorkers) {
    for (const int workers : {1, 2, 5}) {
        options_.workers = workers;
        expect_made(run(first(60),
                        [](int index) {
                            std::this_thread::sleep_for(std::chrono::microseconds(index % 3 * 300));
                            return bytes_of(index);
                        }),
                    60);
    }
    const std::vector<int> some{7, 3, 100};
    const auto taken = run(some, bytes_of);
    ASSERT_EQ(taken.size(), 3u);
    EXPECT_EQ(taken.at(100).bytes, bytes_of(100));
}

TEST_F(WorkerPool, OneWorkerGoesInTheOrderGiven) {
    std::vector<int> order;
    run_in_workers(
        {4, 9, 2, 7}, options_, [] { return bytes_of; }, [&](WorkResult result) { order.push_back(result.index); });
    EXPECT_THAT(order, ::testing::ElementsAre(4, 9, 2, 7));
}

TEST_F(WorkerPool, NothingToDoStartsNoWorker) {
    run_in_workers(
        {}, options_,
        [&]() -> MakeBytes {
            count("started");
            return bytes_of;
        },
        [](WorkResult) { FAIL(); });
    EXPECT_FALSE(fs::exists(folder_ / "started"));
}

TEST_F(WorkerPool, StartRunsOnceInEachWorkerAndNotInTheParent) {
    options_.workers = 3;
    const int parent = ::getpid();
    std::set<std::string> process;
    run_in_workers(
        first(30), options_,
        [&]() -> MakeBytes {
            EXPECT_NE(::getpid(), parent);
            count("started");
            return [](int) {
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
                return std::to_string(::getpid());
            };
        },
        [&](WorkResult result) { process.insert(result.bytes); });
    EXPECT_EQ(fs::file_size(folder_ / "started"), 3u);
    EXPECT_GE(process.size(), 1u);
    EXPECT_LE(process.size(), 3u);
}

TEST_F(WorkerPool, LargeAndEmptyResultsArriveWhole) {
    options_.workers = 2;
    const auto taken = run(first(6), [](int index) {
        std::string bytes(index % 2 ? 10'000'000 : 0, '\0');
        for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 31 + static_cast<size_t>(index));
        return bytes;
    });
    for (const auto& [index, result] : taken) {
        ASSERT_EQ(result.bytes.size(), index % 2 ? 10'000'000u : 0u);
        size_t wrong = 0;
        for (size_t i = 0; i < result.bytes.size(); ++i)
            wrong += result.bytes[i] != static_cast<char>(i * 31 + static_cast<size_t>(index));
        EXPECT_EQ(wrong, 0u) << index;
    }
}

TEST_F(WorkerPool, AWorkerThatDiesOnceCostsNothing) {
    const std::vector<std::function<void()>> death{[] { ::raise(SIGSEGV); }, [] { ::abort(); }, [] { ::_exit(3); },
                                                   [] { ::kill(::getpid(), SIGKILL); },
                                                   [] { throw std::runtime_error("a library's own"); }};
    for (const int workers : {1, 4}) {
        options_.workers = workers;
        for (size_t d = 0; d < death.size(); ++d) {
            const std::string name = std::to_string(workers) + "_" + std::to_string(d);
            expect_made(run(first(20),
                            [&](int index) {
                                if (index % 9 == 5 && count(name + "_" + std::to_string(index)) == 1) death[d]();
                                return bytes_of(index);
                            }),
                        20);
            EXPECT_EQ(fs::file_size(folder_ / (name + "_5")), 2u) << "tried once again";
        }
    }
}

TEST_F(WorkerPool, AWorkerThatDiesTwiceCostsItsIndexOnly) {
    struct Case {
        std::function<void()> death;
        WorkerFailure failure;
        std::string detail;
    };
    const std::vector<Case> all{
        {[] { ::raise(SIGSEGV); }, WorkerFailure::crashed,
         sanitized ? "exit status 1" : "signal 11 (Segmentation fault)"},
        {[] { ::abort(); }, WorkerFailure::crashed, "signal 6 (Aborted)"},
        {[] { ::_exit(3); }, WorkerFailure::crashed, "exit status 3"},
        {[] { throw std::runtime_error("a library's own"); }, WorkerFailure::crashed, "a library's own"},
        {[] { throw 7; }, WorkerFailure::crashed, "an exception without a text"},
        {[] { ::kill(::getpid(), SIGKILL); }, WorkerFailure::out_of_memory, "signal 9 (Killed)"},
        {[] { throw std::bad_alloc(); }, WorkerFailure::out_of_memory, "no memory is left to allocate"}};
    for (const int workers : {1, 4}) {
        options_.workers = workers;
        for (const Case& one : all) {
            const auto taken = run(first(20), [&](int index) {
                if (index == 0 || index == 7 || index == 8 || index == 19) one.death();
                return bytes_of(index);
            });
            expect_made(taken, 20, {0, 7, 8, 19});
            for (const int index : {0, 7, 8, 19}) {
                EXPECT_EQ(taken.at(index).failure, one.failure) << one.detail;
                EXPECT_EQ(taken.at(index).detail, one.detail);
            }
        }
    }
}

TEST_F(WorkerPool, EveryIndexMayFail) {
    options_.workers = 3;
    std::set<int> all;
    for (int i = 0; i < 12; ++i) all.insert(i);
    expect_made(run(first(12), [](int) -> std::string { ::_exit(3); }), 12, all);
    expect_made(run(first(12), [](int) -> std::string { throw std::bad_alloc(); }), 12, all);
}

TEST_F(WorkerPool, TriesAgainInANewProcessAndAloneWhereMemoryRanOut) {
    options_.workers = 3;
    const int lock = ::open((folder_ / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    const auto taken = run(first(40), [&](int index) {
        // opened here: a lock is shared by what a fork duplicates
        const int mine = ::open((folder_ / "lock").c_str(), O_RDWR | O_CLOEXEC);
        static int made_here = 0;
        const int before = made_here++;
        if (index == 10 && count("tries") == 1) throw std::bad_alloc();
        const bool again = index == 10;
        const bool free = ::flock(mine, (again ? LOCK_EX : LOCK_SH) | LOCK_NB) == 0;
        std::this_thread::sleep_for(std::chrono::milliseconds(again ? 50 : 3));
        ::close(mine);
        return std::string(free ? "free" : "taken") + (again && before > 0 ? " old process" : "");
    });
    ::close(lock);
    ASSERT_EQ(taken.size(), 40u);
    for (const auto& [index, result] : taken) EXPECT_EQ(result.bytes, "free") << index;
}

TEST_F(WorkerPool, AMemoryLimitFailsTheIndexThatNeedsMore) {
    if (sanitized) GTEST_SKIP() << "the address sanitizer aborts where an allocation fails";
    options_.workers = 2;
    options_.memory_limit = 400'000'000;
    const auto taken = run(first(8), [](int index) {
        if (index == 3) {
            std::vector<std::unique_ptr<std::vector<char>>> block;  // ends by the limit, in any order of what is freed
            for (int i = 0; i < 1000; ++i) block.push_back(std::make_unique<std::vector<char>>(10'000'000, 'm'));
        }
        if (index == 4) {  // where no exception can get out
            std::thread([] { const std::vector<double> huge(size_t{1} << 40); }).join();
        }
        if (index == 5) return std::string(std::vector<double>(size_t{1} << 40, 1.0).size(), 'x');
        return bytes_of(index);
    });
    expect_made(taken, 8, {3, 4, 5});
    EXPECT_EQ(taken.at(3).failure, WorkerFailure::out_of_memory);
    EXPECT_EQ(taken.at(4).failure, WorkerFailure::out_of_memory);
    EXPECT_EQ(taken.at(5).failure, WorkerFailure::out_of_memory);
}

TEST_F(WorkerPool, ThreadsFitUnderAMemoryLimit) {
    if (sanitized) GTEST_SKIP() << "the address sanitizer maps terabytes";
    options_.memory_limit = 400'000'000;  // malloc reserves 64 MB a thread, without using them
    expect_made(run({0},
                    [](int index) {
                        std::vector<std::thread> thread;
                        std::atomic<int> waiting{0};
                        for (int t = 0; t < 8; ++t)
                            thread.emplace_back([&] {
                                const std::vector<char> own(100'000, 'x');
                                for (++waiting; waiting < 8;) std::this_thread::yield();
                            });
                        for (std::thread& one : thread) one.join();
                        return bytes_of(index);
                    }),
                1);
}

TEST_F(WorkerPool, AnErrorOfStartOrMakeIsThrownWithItsTexts) {
    const auto expect_thrown = [&](const StartWorker& start, const std::string& where) {
        try {
            run_in_workers(first(50), options_, start, [](WorkResult) {});
            FAIL() << "nothing was thrown";
        } catch (const Error& error) {
            EXPECT_STREQ(error.what(), "the pose is wrong");
            EXPECT_EQ(error.where(), where);
            EXPECT_EQ(error.mend(), "take another");
        }
    };
    for (const int workers : {1, 3}) {
        options_.workers = workers;
        expect_thrown([]() -> MakeBytes { throw Error("the pose is wrong", "", "take another"); }, "");
        expect_thrown(
            [] {
                return [](int index) -> std::string {
                    if (index == 20) throw Error("the pose is wrong", "poses.bvh:20", "take another");
                    return bytes_of(index);
                };
            },
            "poses.bvh:20");
    }
    const StartWorker no_folder = []() -> MakeBytes {
        fs::directory_iterator("/nowhere/at/all");
        return bytes_of;
    };
    try {
        run_in_workers(first(5), options_, no_folder, [](WorkResult) {});
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "No such file or directory");
        EXPECT_EQ(error.where(), "/nowhere/at/all");
    }
}

TEST_F(WorkerPool, AWorkerThatCannotStartIsNotStartedForEver) {
    const auto text_of = [&](const StartWorker& start) -> std::string {
        try {
            run_in_workers(first(50), options_, start, [](WorkResult) {});
        } catch (const std::exception& error) {
            return error.what();
        }
        return "nothing was thrown";
    };
    options_.workers = 2;
    EXPECT_THAT(text_of([]() -> MakeBytes { ::_exit(4); }), HasSubstr("exit status 4"));
    EXPECT_THAT(text_of([]() -> MakeBytes { throw std::logic_error("broken"); }), HasSubstr("broken"));
    EXPECT_THAT(text_of([]() -> MakeBytes { throw std::bad_alloc(); }), HasSubstr("run out of memory"));
    const StartWorker second_time = [&]() -> MakeBytes {
        if (count("starts") == 1) ::abort();
        return bytes_of;
    };
    options_.workers = 1;
    EXPECT_EQ(text_of(second_time), "nothing was thrown");
}

TEST_F(WorkerPool, WhatTakeAndIdleThrowEndsTheWork) {
    options_.workers = 3;
    const auto full_disk = [&] {
        run_in_workers(
            first(1000), options_, [] { return bytes_of; },
            [](WorkResult result) {
                if (result.index == 5) throw Error("full");
            });
    };
    EXPECT_THROW(full_disk(), Error);
    const auto no_heartbeat = [&] {
        run_in_workers(
            first(1000), options_,
            [] {
                return [](int index) {
                    std::this_thread::sleep_for(std::chrono::milliseconds(20));
                    return bytes_of(index);
                };
            },
            [](WorkResult) {}, [] { throw Error("full"); });
    };
    EXPECT_THROW(no_heartbeat(), Error);
}

TEST_F(WorkerPool, IdleIsCalledWhileASampleTakesLong) {
    int calls = 0;
    run_in_workers(
        {0}, options_,
        [] {
            return [](int index) {
                std::this_thread::sleep_for(std::chrono::milliseconds(2500));
                return bytes_of(index);
            };
        },
        [](WorkResult) {}, [&] { ++calls; });
    EXPECT_GE(calls, 1);
    EXPECT_LE(calls, 3);
}

TEST_F(WorkerPool, AnInterruptEndsTheWorkAtOnce) {
    std::atomic<bool> interrupted{false};
    options_.workers = 2;
    options_.interrupted = &interrupted;
    int taken = 0;
    const auto work = [&] {
        run_in_workers(
            first(1000), options_,
            [] {
                return [](int index) {
                    if (index == 20) std::this_thread::sleep_for(std::chrono::hours(1));
                    return bytes_of(index);
                };
            },
            [&](WorkResult) {
                if (++taken == 10) interrupted = true;
            });
    };
    EXPECT_THROW(work(), Interrupted);
    EXPECT_GE(taken, 10);
    EXPECT_LT(taken, 30);
}

TEST_F(WorkerPool, WorkersLeaveSignalsOfTheGroupToTheParent) {
    expect_made(run(first(10),
                    [](int index) {
                        ::raise(SIGINT);
                        ::raise(SIGTERM);
                        return bytes_of(index);
                    }),
                10);
}

TEST_F(WorkerPool, GoesOnWhereChildrenAreIgnored) {
    void (*before)(int) = std::signal(SIGCHLD, SIG_IGN);
    const auto taken = run(first(5), [](int index) -> std::string {
        if (index == 2) ::_exit(3);
        return bytes_of(index);
    });
    EXPECT_EQ(std::signal(SIGCHLD, before), SIG_IGN) << "put back";
    expect_made(taken, 5, {2});
    EXPECT_EQ(taken.at(2).detail, "exit status 3");
}

TEST_F(WorkerPool, WorkersCloseWhatIsTheParentsAlone) {
    options_.workers = 3;
    const int own = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    options_.parents_descriptor = {own};
    const auto taken = run(first(12), [own](int index) {
        int sockets = 0;
        for (const auto& entry : fs::directory_iterator("/proc/self/fd")) {
            std::error_code gone;
            sockets += fs::read_symlink(entry.path(), gone).string().rfind("socket:", 0) == 0;
        }
        if (index == 4) ::_exit(1);
        return std::string(::fcntl(own, F_GETFD) == -1 ? "closed" : "open") + " " + std::to_string(sockets);
    });
    int here = 0;  // sockets the test itself was given
    for (const auto& entry : fs::directory_iterator("/proc/self/fd")) {
        std::error_code gone;
        here += fs::read_symlink(entry.path(), gone).string().rfind("socket:", 0) == 0;
    }
    ::close(own);
    for (const auto& [index, result] : taken)
        EXPECT_EQ(result.bytes, index == 4 ? "" : "closed " + std::to_string(here + 1)) << index;
}

/// Waits, ten seconds at most, until none of `process` runs.
bool all_ended(const std::vector<pid_t>& process) {
    for (int i = 0; i < 500; ++i) {
        bool left = false;
        for (const pid_t one : process) {
            std::ifstream file("/proc/" + std::to_string(one) + "/stat");
            std::string id, name, state;
            left |= file >> id >> name >> state && state != "Z";
        }
        if (!left) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
}

TEST_F(WorkerPool, AParentKilledLeavesNoWorkers) {
    options_.workers = 3;
    const pid_t parent = ::fork();
    if (parent == 0) {
        try {
            run_in_workers(
                first(100), options_,
                [&] {
                    std::ofstream(folder_ / ("worker_" + std::to_string(::getpid())));
                    return [](int index) {
                        std::this_thread::sleep_for(std::chrono::hours(index < 50 ? 1 : 0));
                        return bytes_of(index);
                    };
                },
                [](WorkResult) {});
        } catch (...) {
        }
        ::_exit(0);
    }
    std::vector<pid_t> worker;
    while (worker.size() < 3) {
        worker.clear();
        for (const auto& entry : fs::directory_iterator(folder_))
            worker.push_back(std::stoi(entry.path().filename().string().substr(7)));
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ::kill(parent, SIGKILL);
    ASSERT_EQ(::waitpid(parent, nullptr, 0), parent);
    EXPECT_TRUE(all_ended(worker));
}

TEST_F(WorkerPool, WorkersKilledFromOutsideOverAndOverCostNothingButTime) {
    options_.workers = 2;
    // Each worker is killed about its eighth index; one that is tried again is the first of a new worker.
    expect_made(run(first(60),
                    [](int index) {
                        static int made = 0;
                        if (++made == 8 && ::fork() == 0) {
                            ::kill(::getppid(), SIGSEGV);
                            ::_exit(0);
                        }
                        return bytes_of(index);
                    }),
                60);
}

}  // namespace
}  // namespace toile::generate
