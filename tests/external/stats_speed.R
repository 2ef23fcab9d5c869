# Time a call of other programs takes, median in ms; our own by `cargo bench -p maveric-stats`. Needs afex, lmerTest, ordinal.
suppressMessages({library(afex); library(lmerTest); library(ordinal)})
set.seed(1)
d <- expand.grid(id=factor(1:24), style=c("a","b"), traffic=c("x","y"))
u <- rnorm(24); d$y <- u[d$id] + rnorm(nrow(d)) + 0.5*(d$style=="b")
o <- expand.grid(id=factor(1:24), c=factor(1:4)); o$a <- factor(pmin(5,pmax(1,round(3+u[o$id]+rnorm(nrow(o))))), ordered=TRUE)
m <- expand.grid(id=factor(1:24), c=factor(1:4)); m$age <- rnorm(24)[m$id]; m$y <- u[m$id]+rnorm(nrow(m))
med <- function(f, n) { f(); median(replicate(n, {t <- proc.time()[[3]]; f(); (proc.time()[[3]]-t)*1000})) }
cat("afex 24x(2x2):", med(function() suppressMessages(summary(aov_ez("id","y",d,within=c("style","traffic")))), 15), "ms\n")
cat("lmerTest 24x4 + covariate:", med(function() suppressMessages(anova(lmer(y ~ c*age + (1|id), m))), 15), "ms\n")
cat("ordinal clmm 10 nodes 24x4 and its null:", med(function() suppressWarnings({a<-clmm(a ~ c + (1|id), data=o, nAGQ=10); b<-clmm(a ~ 1 + (1|id), data=o, nAGQ=10); c(logLik(a),logLik(b))}), 9), "ms\n")
cat("ordinal clmm Laplace 24x4 and its null:", med(function() suppressWarnings({a<-clmm(a ~ c + (1|id), data=o); b<-clmm(a ~ 1 + (1|id), data=o); c(logLik(a),logLik(b))}), 9), "ms\n")
cat(R.version.string, as.character(packageVersion("afex")), as.character(packageVersion("lmerTest")), as.character(packageVersion("ordinal")), "\n")
