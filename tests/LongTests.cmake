# SPDX-License-Identifier: Apache-2.0
# Tests of ten seconds and more on two cores, label long: whole designs and traces by many ranks, whose code other tests run in
# smaller pieces. The sanitizers take ten times as long for them, half of all, and leave them out (scripts/check.sh asan-long
# tsan-long runs them). A name that is no test fails Tree.LongTestsAreThere.
set(lucerna_long_tests
  Advice.SaysWhatHelps
  BackwardIntensity.FiguresThatAreStoppedAreThoseOfTheCountedRays
  BodyShadows.ADesignThatKnowsTheBodyIsNearerToTheTargetBehindIt
  Design.EveryOptimizerIsSensible
  Design.HoldsTheHeightLimit
  Design.ResumesToTheSameBits
  Design.ShapesAFreeFormMirrorAndKeepsItsSymmetry
  DesignCli.ALimitThatTheLightCannotHoldIsSaidAndExitsWithOne
  DesignCli.ARectangleOnTheFloor
  DesignCli.LeavesFilesWhoseTraceHasTheStatedError
  DesignCli.LimitsAreHeldInTheExportedStl
  DesignLensCli.LeavesWhatAManufacturerAndATraceNeed
  DesignRuns.AreWatchedAndGoOnToTheSameBits
  DesignRuns.LeaveAProjectThatMakesTheSameLight
  DesignRuns.TraceTheResultAndTryTolerancesOnlyWhereAsked
  DeviceTrace.AgreesRayByRayWithTheFastestInstructionSetOffExactMirrors
  DeviceTrace.BodiesAgreeRayByRayWithEmbree
  DeviceTrace.MirrorsThatAreNoHeightFieldAreTheCpusToTheBit
  DistributedNoiseTest.EndsAtTheRoundAndTheBitsOfOneProcess
  DistributedTraceTest.GoesOnFromAnySplitToTheSameBits
  DistributedTraceTest.IsTheTraceOfOneProcessForAnyRanksAndChunks
  FreeFormSearch.EndsAtTheSameBitsHoweverOftenItWasStopped
  FreeFormSearch.NeverEndsWorseThanItsStartAndNeverCoarsensIt
  FreeFormSearch.OfALongSourceALevelGoesOnToTheSameBits
  FreeFormSearch.ReachesAFarTargetFromThePlainParaboloid
  LensDesign.KeepsItsLimits
  LensEvaluation.DerivativesAgreeWithCentralDifferences
  ModelsCli.PointsLinesAndPlanesAreCompressedSampledAndTraced
  PlaneTarget.AMirrorIsShapedForARectangleOnTheFloor
  Report.ADesignsFolderIsWrittenAndReported
  ResultFields.AreThoseOfRealFiles
  SharedDesign.TolerancesAreSharedByCase
  WideTrace.TwoLanesGoThroughFiles
  ZoneCost.ASearchEndsWithTheBandsHeld)
